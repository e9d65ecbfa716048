"""Columns of ``sensor_msgs/JointState`` in an MCAP file."""

from __future__ import annotations

import mmap
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, cast

import lz4.frame
import numpy as np
import zstandard
from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap_ros2.decoder import DecoderFactory

from slidetune.robot.recordings.limits import LARGEST_FILE, MOST_COLUMNS, MOST_ROWS
from slidetune.robot.recordings.refused import RecordingError, listed, quoted

Array = np.ndarray

_KIND = ("sensor_msgs/msg/JointState", "sensor_msgs/JointState")
_LARGEST_CHUNK = 32 * 1024 * 1024
"""Most bytes of a chunk once it is unpacked (*ours*); usual ones have one to four MB."""
_LARGEST_WHOLE = 1024 * 1024 * 1024
"""Most bytes of all chunks once they are unpacked (*ours*)."""
_LARGEST_SCHEMA = 64 * 1024
"""Most bytes of the text that says how a message is laid out (*ours*); it has 3000."""
_LOOKED_AT = 200
"""Messages whose joints make the header (*ours*): several publishers may share a topic."""
_FIELDS = ("position", "velocity", "effort")
TIME = "time [ns]"


class _State(NamedTuple):
    """One message: its stamp in [ns], its joints, and position, velocity and effort of each."""

    stamp: int
    names: list[str]
    parts: dict[str, Sequence[float]]


class McapFile:
    """The messages of one topic of joint states.

    Attributes:
        names: ``time [ns]``, then ``joint/position``, ``joint/velocity`` and ``joint/effort``.
        topics: topics of joint states in the file.
        rows_are: what a row is called.
    """

    rows_are = "message"

    def __init__(self, path: Path, topic: str | None = None) -> None:
        """See which topics and joints there are.

        Args:
            path: the file.
            topic: which topic counts where several hold joint states.

        Raises:
            RecordingError: if there is none, or several and none is named.
        """
        self._path = path
        self.topics = self._topics()
        self.topic = _chosen(self.topics, topic)
        joints: dict[str, None] = {}
        for state in self._states(_LOOKED_AT):
            joints.update(dict.fromkeys(state.names))
        if len(joints) * len(_FIELDS) > MOST_COLUMNS:
            raise RecordingError(f"has {len(joints)} joints, at most {MOST_COLUMNS // 3} are read")
        if not joints:
            raise RecordingError(f"{self.topic} has no message with a position in it")
        self._places = [(TIME, "")] + [(name, part) for part in _FIELDS for name in joints]
        self.names = (TIME, *(f"{name}/{part}" for name, part in self._places[1:]))
        self.skipped = 0

    def read(self, wanted: Sequence[int]) -> tuple[Array, Array]:
        """Return some of the columns, and the number of each message; see ``CsvFile.read``.

        Time counts from the first message. Messages that lack one of the joints are left out and
        counted in ``skipped``.
        """
        places = [self._places[column] for column in wanted]
        rows: list[list[float]] = []
        numbers: list[int] = []
        origin, asked = None, {name for name, part in places if part}
        seen: list[str] = []
        order: dict[str, int] = {}
        self.skipped = 0
        for number, state in enumerate(self._states(None), 1):
            if state.names != seen:
                seen, order = state.names, {name: i for i, name in enumerate(state.names)}
            if not asked <= order.keys():
                self.skipped += 1
                continue
            if len(rows) == MOST_ROWS:
                raise RecordingError(f"has more than {MOST_ROWS:,} messages: cut it")
            origin = state.stamp if origin is None else origin
            rows.append(
                [
                    _at(state.parts[part], order[name]) if part else float(state.stamp - origin)
                    for name, part in places
                ]
            )
            numbers.append(number)
        return np.array(rows).reshape(len(rows), len(wanted)), np.array(numbers, int)

    def _topics(self) -> dict[str, int]:
        """Return how many messages of joint states each topic has."""
        kinds: dict[int, str] = {}
        schemas: dict[int, Schema] = {}
        found: dict[str, int] = {}
        others: set[str] = set()
        with self._records() as records:
            for record in records:
                if isinstance(record, Schema):
                    schemas[record.id] = record
                elif isinstance(record, Channel):
                    schema = schemas.get(record.schema_id)
                    name = schema.name if schema is not None else ""
                    if name in _KIND:
                        kinds[record.id] = record.topic
                        found.setdefault(record.topic, 0)
                    else:
                        others.add(f"{record.topic} ({name or record.message_encoding})")
                elif isinstance(record, Message) and record.channel_id in kinds:
                    found[kinds[record.channel_id]] += 1
        if not found:
            known = listed(sorted(others)) or "none"
            raise RecordingError(f"holds no sensor_msgs/JointState: its topics are {known}")
        return found

    def _states(self, most: int | None) -> Iterator[_State]:
        """Yield what each message of the topic says."""
        schemas: dict[int, Schema] = {}
        decoders: dict[int, Any] = {}
        factory, count = DecoderFactory(), 0
        with self._records() as records:
            for record in records:
                if isinstance(record, Schema):
                    schemas[record.id] = record
                elif isinstance(record, Channel) and record.topic == self.topic:
                    schema = schemas.get(record.schema_id)
                    if schema is not None and schema.name in _KIND:
                        decoders[record.id] = _decoder(factory, record, schema)
                elif isinstance(record, Message) and record.channel_id in decoders:
                    yield _state(decoders[record.channel_id](record.data), record)
                    count += 1
                    if count == most:
                        return

    @contextmanager
    def _records(self) -> Iterator[Iterator[Any]]:
        """Give all records; whatever a damaged file makes of them is one refusal."""
        try:
            with (
                self._path.open("rb") as file,
                closing(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)) as memory,
            ):
                yield _unpacked(cast(Any, memory))
        except RecordingError:
            raise
        except Exception as error:  # the readers raise whatever the bytes lead them to
            name = type(error).__name__
            raise RecordingError(
                f"can't be read as MCAP ({name}: {str(error)[:200]}): mcap recover makes what can "
                "be read of it into a new file"
            ) from error


def _unpacked(memory: Any) -> Iterator[Any]:
    reader = StreamReader(memory, emit_chunks=True, record_size_limit=LARGEST_FILE)
    whole = 0
    for record in reader.records:
        if isinstance(record, Chunk):
            data = _bytes_of(record)
            whole += len(data)
            if whole > _LARGEST_WHOLE:
                raise RecordingError(
                    f"unpacks to more than {_LARGEST_WHOLE // 2**20} MB: write the joint states "
                    "alone into a file, by mcap filter"
                )
            yield from breakup_chunk(replace(record, compression="", data=data))
        else:
            yield record


def _bytes_of(chunk: Chunk) -> bytes:
    """Unpack a chunk, and no more of it than a chunk may have."""
    if chunk.uncompressed_size > _LARGEST_CHUNK:
        raise RecordingError(
            f"has a chunk of {chunk.uncompressed_size / 2**20:.0f} MB, at most "
            f"{_LARGEST_CHUNK // 2**20} MB are read: write it with smaller chunks"
        )
    if chunk.compression == "zstd":
        unpacker = zstandard.ZstdDecompressor().decompressobj()
        data = b"".join(_pieces(unpacker, chunk))
    elif chunk.compression == "lz4":
        data = lz4.frame.LZ4FrameDecompressor().decompress(
            chunk.data, max_length=chunk.uncompressed_size + 1
        )
    elif chunk.compression == "":
        data = chunk.data
    else:
        raise RecordingError(f"is compressed by {quoted(chunk.compression)}: zstd and lz4 are read")
    if len(data) != chunk.uncompressed_size:
        raise RecordingError("has a chunk that isn't as long as it says")
    return bytes(data)


def _pieces(unpacker: Any, chunk: Chunk) -> Iterator[bytes]:
    """Unpack zstd piece by piece, so that a small file makes no endless one."""
    length, size = 0, 4096
    for begin in range(0, len(chunk.data), size):
        piece = unpacker.decompress(chunk.data[begin : begin + size])
        length += len(piece)
        if length > chunk.uncompressed_size:
            raise RecordingError("has a chunk that is longer than it says")
        yield piece


def _decoder(factory: DecoderFactory, channel: Channel, schema: Schema) -> Any:
    if len(schema.data) > _LARGEST_SCHEMA:
        raise RecordingError(f"{schema.name} has a definition of {len(schema.data)} bytes")
    decoder = factory.decoder_for(channel.message_encoding, schema)
    if decoder is None:
        raise RecordingError(
            f"{channel.topic} is encoded as {quoted(channel.message_encoding)} with a schema in "
            f"{quoted(schema.encoding)}: cdr with ros2msg is read, which ROS 2 records"
        )
    return decoder


def _chosen(topics: dict[str, int], wanted: str | None) -> str:
    if wanted is not None:
        for topic in topics:
            if topic.strip("/") == wanted.strip("/"):
                return topic
        text = f"has no joint states on {quoted(wanted)}: there are {listed(list(topics))}"
        raise RecordingError(text, names=tuple(topics))
    if len(topics) > 1:
        raise RecordingError(
            f"has joint states on {listed(list(topics))}: say which counts by naming it as the "
            "source",
            names=tuple(topics),
        )
    return next(iter(topics))


def _state(message: Any, record: Message) -> _State:
    """Return what a message says; joints are numbers from 1 where it names none."""
    stamp, count = message.header.stamp, len(message.position)
    names = [str(name) for name in message.name]
    if len(names) != count:
        names = [str(number + 1) for number in range(count)]
    parts = {part: getattr(message, part) for part in _FIELDS}
    # When it was measured, or recorded where its stamp is empty.
    nanoseconds = int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
    return _State(nanoseconds or record.log_time, names, parts)


def _at(values: Sequence[float], place: int) -> float:
    """Return a value; NaN where a message lacks it: effort and velocity may be empty."""
    return float(values[place]) if place < len(values) else np.nan
