"""What the server answers and logs below the application: requests and messages that are none."""

from __future__ import annotations

import json
import logging
from typing import Any

from uvicorn.protocols.http.auto import AutoHTTPProtocol
from uvicorn.protocols.websockets.auto import AutoWebSocketsProtocol

from server.errors import error_body
from server.security_headers import RAW_HEADERS

_FOREIGN_TEXT = "Invalid UTF-8 sequence received from client."


class RawHttp(AutoHTTPProtocol):  # type: ignore[misc, valid-type]
    """Uvicorn's protocol, but what isn't HTTP is answered in the shape that all errors have."""

    def send_400_response(self, msg: str) -> None:
        """Answer 400 and hang up."""
        body = json.dumps(error_body("bad_request", msg)).encode()
        headers = {
            **RAW_HEADERS,
            "content-type": "application/json",
            "content-length": str(len(body)),
            "connection": "close",
        }
        lines = [
            "HTTP/1.1 400 Bad Request",
            *(f"{name}: {value}" for name, value in headers.items()),
        ]
        self.transport.write("\r\n".join([*lines, "", ""]).encode() + body)
        self.transport.close()


class RawWebSocket(AutoWebSocketsProtocol):  # type: ignore[misc, valid-type]
    """Uvicorn's protocol, but a WebSocket that isn't opened is refused with the headers of all."""

    def handle_connect(self, event: Any) -> None:
        """Answer a request to open a WebSocket."""
        reject = self.conn.reject

        def rejected(*args: Any) -> Any:
            response = reject(*args)
            response.headers.update(RAW_HEADERS)
            return response

        self.conn.reject = rejected
        super().handle_connect(event)


def _is_news(record: logging.LogRecord) -> bool:
    return record.msg != _FOREIGN_TEXT


def leave_foreign_text_out_of_the_log() -> None:
    """Log no traceback of ours where a client's WebSocket message isn't UTF-8: it is closed."""
    logging.getLogger("uvicorn.error").addFilter(_is_news)
