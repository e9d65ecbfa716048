"""A dashboard that runs somewhere, from Python: change it, follow it, ask it for whole runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from urllib.parse import parse_qs, quote, urlsplit

import httpx
from websockets.exceptions import InvalidHandshake
from websockets.sync.client import connect as open_socket

from slidetune.robot.errors import SlidetuneError
from slidetune.robot.experiment.document import Experiment
from slidetune.server.client.refusal import DashboardError, checked
from slidetune.server.client.telemetry import Telemetry, TelemetryStream, joined
from slidetune.server.client.whole_response import WholeResponse, decoded_response

Document = Mapping[str, Any]

PATIENCE = 60.0
"""Time for an answer in [s] (*ours*): a whole response of a long horizon takes some."""


class Dashboard:
    """The live session of a server, as its page has it; use it in a ``with``, or ``close`` it.

    Every method raises ``DashboardError`` where the server can't be reached or doesn't allow it,
    and ``InvalidExperimentError`` naming every field that it refuses; nothing is changed then.
    """

    def __init__(self, address: str, token: str | None = None) -> None:
        """Connect; see ``slidetune.connect``."""
        parts = urlsplit(address if "//" in address else f"http://{address}")
        if parts.scheme not in ("http", "https") or not parts.netloc:
            raise DashboardError(f"{address!r} is no address of a dashboard: http://HOST:PORT/")
        token = token or parse_qs(parts.query).get("token", [None])[0]
        self._headers = {"authorization": f"Bearer {token}"} if token else {}
        base = f"{parts.scheme}://{parts.netloc}{parts.path.rstrip('/')}"
        self._live = f"ws{base.removeprefix('http')}/api/live"
        # With a transport of its own: no proxy of the environment, as for the WebSocket.
        transport = httpx.HTTPTransport()
        self._http = httpx.Client(
            base_url=base, headers=self._headers, timeout=PATIENCE, transport=transport
        )
        try:
            self.version = str(self._ask("GET", "/api/health").json()["version"])
        except (SlidetuneError, KeyError, ValueError) as error:
            self._http.close()
            if isinstance(error, SlidetuneError):
                raise
            raise DashboardError(f"what answers at {base} is no Slidetune") from error

    def __enter__(self) -> Dashboard:
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """End the connections; the live session goes on."""
        self._http.close()

    @property
    def experiment(self) -> Experiment:
        """The experiment in force."""
        return Experiment.from_document(self._ask("GET", "/api/experiment").json()["experiment"])

    def patch(self, patch: Document) -> Experiment:
        """Change the experiment as a slider does, by a JSON Merge Patch (RFC 7396).

        Args:
            patch: such as ``{"lanes": {"NFTSM": {"nu": 30}}}``; ``None`` removes.

        Returns:
            The experiment after it.
        """
        return _experiment(self._ask("PATCH", "/api/experiment", patch))

    def replace(self, experiment: Experiment | Document) -> Experiment:
        """Begin another experiment at time 0."""
        document = experiment.document() if isinstance(experiment, Experiment) else experiment
        return _experiment(self._ask("PUT", "/api/experiment", document))

    def load(self, preset: str) -> Experiment:
        """Begin a preset of the server's, by its name, at time 0."""
        return _experiment(self._ask("POST", f"/api/presets/{quote(preset, safe='')}/load"))

    def play(self) -> None:
        """Let time go on."""
        self._ask("POST", "/api/session/play")

    def pause(self) -> None:
        """Stop time."""
        self._ask("POST", "/api/session/pause")

    def reset(self, lane: str | None = None) -> None:
        """Go back to time 0, or restart one lane at the present point of the trajectory."""
        self._ask("POST", "/api/session/reset", {"lane": lane} if lane else None)

    def metrics(self) -> dict[str, Any]:
        """Return each lane's figures, as ``GET /api/metrics`` has them, in SI units."""
        found: dict[str, Any] = self._ask("GET", "/api/metrics").json()
        return found

    def preview(
        self, patch: Document | None = None, experiment: Experiment | None = None
    ) -> WholeResponse:
        """Run every lane over the horizon beside the live session, which goes on as it is.

        Args:
            patch: to the live experiment, or to ``experiment``.
            experiment: another one in its place.
        """
        document = None if experiment is None else experiment.document()
        wanted = {"patch": dict(patch or {}), "experiment": document}
        return decoded_response(self._ask("POST", "/api/preview", wanted).content)

    def telemetry(self) -> TelemetryStream:
        """Follow the live session: ``with dashboard.telemetry() as rows: for some in rows: …``."""
        try:
            socket = open_socket(
                self._live,
                additional_headers=self._headers,
                open_timeout=PATIENCE,
                proxy=None,
                max_size=None,
            )
        except (OSError, InvalidHandshake, TimeoutError) as error:
            raise DashboardError(f"no telemetry from {self._live}: {error}") from error
        return TelemetryStream(socket)

    def record(self, seconds: float) -> Telemetry:
        """Return the next rows of the live session, as many as these seconds of its time hold.

        A session that is paused has none: this waits until it plays.

        Raises:
            ValueError: if the lanes are others meanwhile.
        """
        parts: list[Telemetry] = []
        with self.telemetry() as rows:
            for some in rows:
                if parts and some.time[0] < parts[-1].time[-1]:
                    parts.clear()  # it went back to time 0
                parts.append(some)
                if some.time[-1] - parts[0].time[0] >= seconds:
                    break
        return joined(parts)

    def _ask(self, method: str, path: str, body: Document | None = None) -> httpx.Response:
        try:
            answer = self._http.request(method, path, json=body)
        except httpx.TransportError as error:
            text = f"no Slidetune answers at {self._http.base_url}: {error}"
            raise DashboardError(text) from error
        return checked(answer)


def _experiment(answer: httpx.Response) -> Experiment:
    return Experiment.from_document(answer.json()["experiment"])
