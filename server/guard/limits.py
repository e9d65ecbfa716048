"""Every limit of the server in one place, and the refusals of those that can be reached in words.

They keep a runaway script or a forgotten tab from taking the live session's time; they are no
defence against a person who holds the owner's token and means harm.
"""

from __future__ import annotations

from slidetune.robot.errors import SlidetuneError
from slidetune.robot.fields.plain_values import MOST_KEYS
from slidetune.robot.recordings.limits import LARGEST_FILE

MAX_CLIENTS = 128
"""Most clients of the live WebSocket at once, and most of the 3D scene's (*ours*)."""
MAX_MESSAGE = 256 * 1024
"""Largest WebSocket message that a client may send in bytes (*ours*)."""
MAX_LIVE_MESSAGE = 64 * 1024
"""Most characters of a message to the live session (*ours*): a patch of everything that there is
takes 20 kB. A longer one is refused in words."""
MAX_BODY = 256 * 1024
"""Largest body of an HTTP request in bytes, on every route but those for arms and logs
(*ours*)."""
MAX_ARM = 100 * 1024 * 1024
"""Largest description of an arm with its meshes that can be sent, in bytes (*ours*)."""
MAX_LOG = LARGEST_FILE + 1024 * 1024
"""Largest log of a real arm that can be sent, in bytes (*ours*): the file and what is around it."""
MAX_LOGS = 4
"""Most logs that are kept at once (*ours*): two to show, and two to change them for."""
MAX_HAND_OVERS = 2
"""Most hand-overs that are made at once (*ours*), each in a process of its own."""
MAX_EXPORTS = 2
"""Most exports that are written at once (*ours*), each in a process of its own."""
MAX_REPORTS = 2
"""Most reports that are made at once (*ours*), the replay of each in a process of its own."""
CLIENT_RATE = 240.0
"""Messages a second that one client may send over the live WebSocket (*ours*): four times what a
drag sends at 60 pictures a second. Frames that bring no whole message, such as pings, may come as
fast; faster ones end their connection."""
CLIENT_BURST = 480
"""Messages that it may send at once after a rest (*ours*)."""
TOTAL_RATE = 480.0
"""Patches a second from all WebSockets together (*ours*): eight hands that drag at full speed."""
TOTAL_BURST = 960
"""Patches at once after a rest, from all of them (*ours*)."""
SCENE_RATE = 240.0
"""Messages a second from one browser to the 3D scene; faster ones wait (*ours*)."""
SCENE_BURST = 480
"""Messages to the 3D scene that pass at once after a rest (*ours*)."""
MAX_STUDIES = 8
"""Most studies under way at once; each has one run in the workers at a time (*ours*)."""
MAX_KEPT_STUDIES = 200
"""Most studies that are kept (*ours*): listing them reads each experiment once."""
MAX_FOLLOWED = 32
"""Most clients that follow a study at once (*ours*)."""
MAX_PRESETS = 200
"""Most presets of the user's own (*ours*): listing them reads each once, about 10 ms."""


class LimitError(SlidetuneError, RuntimeError):
    """As much as the server takes is under way already; asking again later helps."""


class TooManyPatchesError(LimitError):
    """Messages come faster than they may."""


class MessageTooLargeError(SlidetuneError, ValueError):
    """More in one message than any needs."""


class SessionBusyError(LimitError):
    """As many commands wait for the live session as may."""


class TooManyStudiesError(LimitError):
    """As many studies as may be are under way."""


class TooManyKeptStudiesError(LimitError):
    """There are as many studies as may be."""


class TooManyLogsError(LimitError):
    """There are as many logs as may be."""


class TooManyPresetsError(LimitError):
    """There are as many presets as may be."""


def limits_document() -> dict[str, int]:
    """Return the limits that a client can run into, by name; sizes in bytes, rates a second."""
    return {
        "clients": MAX_CLIENTS,
        "message_bytes": MAX_MESSAGE,
        "live_message_characters": MAX_LIVE_MESSAGE,
        "message_keys": MOST_KEYS,
        "body_bytes": MAX_BODY,
        "arm_bytes": MAX_ARM,
        "log_bytes": LARGEST_FILE,
        "logs": MAX_LOGS,
        "hand_overs": MAX_HAND_OVERS,
        "exports": MAX_EXPORTS,
        "reports": MAX_REPORTS,
        "client_messages_a_second": int(CLIENT_RATE),
        "client_messages_at_once": CLIENT_BURST,
        "all_patches_a_second": int(TOTAL_RATE),
        "all_patches_at_once": TOTAL_BURST,
        "scene_messages_a_second": int(SCENE_RATE),
        "studies": MAX_STUDIES,
        "kept_studies": MAX_KEPT_STUDIES,
        "followed_studies": MAX_FOLLOWED,
        "presets": MAX_PRESETS,
    }
