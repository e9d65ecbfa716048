"""What the server answers below the application: requests that are none."""

from __future__ import annotations

import json

from uvicorn.protocols.http.auto import AutoHTTPProtocol

from slidetune.server.guard.errors import error_body
from slidetune.server.guard.security_headers import RAW_HEADERS


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
