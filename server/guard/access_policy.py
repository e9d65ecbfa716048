"""What a request must bring: the host it names, and a token for each of two roles.

The *owner* may do everything. A *viewer* may look at everything and change nothing.
"""

from __future__ import annotations

import ipaddress
import re
import secrets
from dataclasses import dataclass, field
from hmac import compare_digest
from typing import Literal
from urllib.parse import quote

from slidetune.server.guard.own_addresses import own_addresses

Role = Literal["owner", "viewer"]

WATCH_ONLY = (
    "You are watching: with this address you can see the live session, but not change anything or "
    "start a computation. For that, use the owner's address, which the server printed when it "
    "started."
)
"""Said to a viewer who asks for more."""

_HOST = re.compile(r"([A-Za-z0-9._-]+|\[[0-9A-Fa-f:.]+\])(?::([0-9]{1,5}))?")
_DEFAULT_PORTS = {"http": 80, "ws": 80, "https": 443, "wss": 443}


@dataclass(frozen=True)
class AccessPolicy:
    """Who may talk to a server, and as what.

    Attributes:
        host: the name or address that the server is bound to.
        port: the TCP port that it is bound to.
        token: the owner's secret, or None where no token is asked for; left out of the repr.
        viewer_token: the viewers' secret, or None where there are no viewers; left out as well.
    """

    host: str
    port: int
    token: str | None = field(default=None, repr=False)
    viewer_token: str | None = field(default=None, repr=False)

    @property
    def cookie(self) -> str:
        """Name of the cookie; it holds the port because all ports of a host share cookies."""
        return f"slidetune_{self.port}"

    def address(self) -> str:
        """Return the owner's address to open, token included: print it, never log it."""
        return self.addresses("owner")[0]

    def addresses(self, role: Role) -> list[str]:
        """Return the addresses to open in a role, token included, the surest first.

        Args:
            role: for whom. None are returned for viewers where there is no token for them.
        """
        token = self.token if role == "owner" else self.viewer_token
        if role == "viewer" and token is None:
            return []
        query = "" if token is None else f"?token={quote(token, safe='')}"
        hosts = own_addresses(self.host)
        return [f"http://{_bracketed(host)}:{self.port}/{query}" for host in hosts]

    def allows_host(self, host: str, scheme: str) -> bool:
        """Say whether a Host header may name this server (rule 1 of ``server.guard.access``)."""
        if self.token is not None or not is_loopback(self.host):
            return _HOST.fullmatch(host) is not None
        names = ("localhost", "127.0.0.1", "[::1]", _bracketed(self.host).lower())
        return split_host(host, scheme) in [(name, self.port) for name in names]

    def role_of(self, given: str | None) -> Role | None:
        """Return the role that a token gives, in constant time; None where it gives none.

        Where no token is asked for everybody is the owner.
        """
        if self.token is None:
            return "owner"
        if given is None:
            return None
        if _same(given, self.token):
            return "owner"
        return "viewer" if self.viewer_token and _same(given, self.viewer_token) else None


def policy_for(host: str, port: int, token: bool = False) -> AccessPolicy:
    """Return the policy of a server that binds this address, with new tokens if it needs them.

    Args:
        host: the name or address to bind. `localhost` and loopback addresses need no token;
            every other name does, and so does the empty one, which binds all interfaces.
        port: the TCP port to bind.
        token: whether to ask for a token on loopback too, as behind a proxy.
    """
    if is_loopback(host) and not token:
        return AccessPolicy(host, port)
    return AccessPolicy(host, port, secrets.token_urlsafe(32), secrets.token_urlsafe(32))


def is_loopback(host: str) -> bool:
    """Say whether a name or address can only be reached from this machine."""
    if host.lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def split_host(host: str, scheme: str) -> tuple[str, int] | None:
    """Return name and port of a Host header; None where it isn't well-formed.

    Args:
        host: the header.
        scheme: its port is meant where the header names none.
    """
    match = _HOST.fullmatch(host)
    return match and (match[1].lower(), int(match[2] or _DEFAULT_PORTS[scheme]))


def same_origin(origin: str, host: str) -> bool:
    """Say whether an Origin header is the page of the server that a Host header names."""
    # The Origin's own scheme fills in missing ports: behind a proxy that ends TLS ours differs.
    scheme, _, rest = origin.partition("://")
    if scheme not in ("http", "https"):
        return False
    named = split_host(rest, scheme)
    return named is not None and named == split_host(host, scheme)


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def _same(given: str, secret: str) -> bool:
    return compare_digest(given.encode(), secret.encode())
