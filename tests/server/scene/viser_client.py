"""A browser's side of Viser without the browser: it keeps what the scene looks like."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Self

import msgspec
import numpy as np
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

DEADLINE = 20.0  # s, only reached by a test that fails

Message = dict[str, Any]


def until(condition: Callable[[], bool], action: Callable[[], object] = lambda: None) -> None:
    """Repeat `action` until `condition` holds."""
    end = time.monotonic() + DEADLINE
    while not condition():
        assert time.monotonic() < end, "waited too long"
        action()
        time.sleep(0.005)


def decoded(data: bytes) -> list[Message]:
    """Return the messages of one of Viser's frames."""
    size, packed = (int.from_bytes(data[at : at + 8], "little") for at in (0, 8))
    inner = zstandard.ZstdDecompressor().decompress(data[16 : 16 + packed], size)
    content = msgspec.msgpack.decode(inner)
    at, buffers = 16 + packed, []
    for length in content["binaryBufferLengths"]:
        at += -at % 8
        buffers.append(data[at : at + length])
        at += length
    return [_filled(message, buffers) for message in content["messages"]]


def _filled(value: Any, buffers: list[bytes]) -> Any:
    if isinstance(value, dict):
        if "__binary_index" in value:
            return np.frombuffer(buffers[value["__binary_index"]], dtype=value["dtype"])
        return {key: _filled(item, buffers) for key, item in value.items()}
    return tuple(value) if isinstance(value, list) else value


@dataclass
class Seen:
    """What a browser has of the scene, see `ViserClient`."""

    nodes: dict[str, Message] = field(default_factory=dict)
    poses: dict[str, Message] = field(default_factory=dict)
    visible: dict[str, bool] = field(default_factory=dict)
    bindings: dict[str, tuple[Message, ...]] = field(default_factory=dict)
    others: dict[str, Message] = field(default_factory=dict)

    def copy(self) -> Seen:
        """Return the same in dicts of its own, those of the nodes included."""
        nodes, poses = (
            {name: dict(node) for name, node in every.items()} for every in (self.nodes, self.poses)
        )
        return Seen(nodes, poses, dict(self.visible), dict(self.bindings), dict(self.others))

    def take(self, message: Message) -> None:
        """Follow one message."""
        kind, name = message["type"], message.get("name", "")
        if kind == "SceneNodeUpdateMessage":
            self.nodes[name].update(message["updates"])
        elif kind == "SetSceneNodeVisibilityMessage":
            self.visible[name] = message["visible"]
        elif kind == "SetSceneNodeDragBindingsMessage":
            self.bindings[name] = message["bindings"]
        elif kind in ("SetPositionMessage", "SetOrientationMessage"):
            part = "position" if kind == "SetPositionMessage" else "wxyz"
            self._pose(name)[part] = np.array(message[part])
        elif kind == "RemoveSceneNodeMessage":
            self.nodes.pop(name)
        elif "props" in message and name:
            self.nodes[name] = dict(message["props"])
            self._pose(name)
        else:
            self.others[kind] = message

    def _pose(self, name: str) -> Message:
        rest = {"position": np.zeros(3), "wxyz": np.array([1.0, 0.0, 0.0, 0.0])}
        return self.poses.setdefault(name, rest)


class ViserClient:
    """Connects like a browser and follows the scene until it is closed.

    The port is Viser's own, or with the path "/scene/" that of a server that relays it.

    Attributes:
        count: messages received, without those of the connection itself.
        replayed: how many of them had been kept for newcomers, -1 until all have come.
        nodes: properties of every node by name.
        poses: position and orientation wxyz of every node by name.
        visible: whether each node is shown.
        bindings: what each node may be dragged with.
        others: last message of each other type.
    """

    def __init__(self, port: int, path: str = "/") -> None:
        self.count, self.replayed = 0, -1
        self._seen = Seen()
        self._socket = connect(
            f"ws://127.0.0.1:{port}{path}",
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            compression=None,
            max_size=None,
            proxy=None,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        # Viser counts a browser in when it has said where its camera is.
        numbers = {"fov": 0.7, "near": 0.1, "far": 10.0, "image_height": 700, "image_width": 900}
        vectors = {"position": (1.0, 1.0, 1.0), "look_at": (0.0,) * 3, "up_direction": (0, 0, 1.0)}
        self.send("ViewerCameraMessage", wxyz=(1.0, 0.0, 0.0, 0.0), **numbers, **vectors)
        until(lambda: self.replayed >= 0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def nodes(self) -> dict[str, Message]:
        return self._seen.nodes

    @property
    def poses(self) -> dict[str, Message]:
        return self._seen.poses

    @property
    def visible(self) -> dict[str, bool]:
        return self._seen.visible

    @property
    def bindings(self) -> dict[str, tuple[Message, ...]]:
        return self._seen.bindings

    @property
    def others(self) -> dict[str, Message]:
        return self._seen.others

    def close(self) -> None:
        self._socket.close()
        self._reader.join()

    def break_off(self) -> None:
        """Go without a word, in the middle of whatever comes."""
        self._socket.socket.shutdown(socket.SHUT_RDWR)
        self.wait_closed()

    def wait_closed(self) -> None:
        """Wait until the connection is gone."""
        self._reader.join(DEADLINE)
        assert not self._reader.is_alive(), "the connection stayed"
        self._socket.close()

    def send(self, kind: str, **fields: Any) -> None:
        self._socket.send(msgspec.msgpack.encode({"type": kind, **fields}))

    def drag(self, phase: str, name: str, position: Any = None) -> None:
        """Say that the pointer has taken, moved or left a handle."""
        kinds = {"start": "DragStart", "update": "Update", "end": "DragEnd"}
        place = {
            "wxyz": (1.0, 0.0, 0.0, 0.0),
            "position": tuple(map(float, () if position is None else position)),
        }
        fields = place if phase == "update" else {}
        self.send(f"TransformControls{kinds[phase]}Message", name=name, **fields)

    def drag_node(self, phase: str, name: str, start: Any, end: Any, modifier: Any) -> None:
        """Say that the pointer drags a node from where it has taken it to where it is now."""
        self.send(
            "SceneNodeDragMessage",
            phase=phase,
            name=name,
            instance_index=None,
            start_position=tuple(map(float, start)),
            start_screen_pos=(0.5, 0.5),
            end_position=tuple(map(float, end)),
            end_screen_pos=(0.5, 0.5),
            button="left",
            modifier=modifier,
        )

    def _read(self) -> None:
        with suppress(ConnectionClosed):
            while True:
                self._take(decoded(bytes(self._socket.recv())))  # type: ignore[arg-type]

    def _take(self, messages: list[Message]) -> None:
        """Follow a frame. A test that looks meanwhile sees it whole or not at all."""
        count, replayed, seen = self.count, self.replayed, self._seen.copy()
        for message in messages:
            if message["type"] == "ReplayDoneMessage":
                replayed = count
            else:
                count += 1
                seen.take(message)
        self._seen, self.count, self.replayed = seen, count, replayed
