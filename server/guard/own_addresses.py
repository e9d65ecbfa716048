"""By which names and addresses this machine is reached."""

from __future__ import annotations

import ipaddress
import socket
from contextlib import suppress

# Addresses set aside for documentation (RFC 5737, RFC 3849). Connecting a UDP socket sends
# nothing: the system only chooses the address that it would send from.
_ELSEWHERE = {socket.AF_INET: "192.0.2.1", socket.AF_INET6: "2001:db8::1"}


def own_addresses(host: str) -> list[str]:
    """Return where others reach a server that is bound to ``host``, the surest first.

    A server bound to one name or address is reached by that. One bound to all interfaces is
    reached by the address that this machine uses towards others, which works everywhere, and by
    its name, which works where the network knows it. Offline the name's own addresses stand in.

    Args:
        host: the name or address that the server is bound to; empty for all interfaces.
    """
    if host not in ("", "0.0.0.0", "::"):
        return [host]
    families = [socket.AF_INET, *([socket.AF_INET6] if host == "::" else [])]
    routed = [address for family in families if (address := _towards_others(family))]
    found = routed or _of_own_name(families)
    return [*dict.fromkeys(found), socket.gethostname()]


def _towards_others(family: socket.AddressFamily) -> str:
    with suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as probe:
        probe.connect((_ELSEWHERE[family], 9))
        address = str(probe.getsockname()[0])
        if _is_reachable(address):
            return address
    return ""


def _of_own_name(families: list[socket.AddressFamily]) -> list[str]:
    try:
        known = socket.getaddrinfo(socket.gethostname(), None, type=socket.SOCK_DGRAM)
    except OSError:
        return []
    addresses = [str(place[0]) for family, *_, place in known if family in families]
    return [address for address in addresses if _is_reachable(address)]


def _is_reachable(address: str) -> bool:
    try:
        parsed = ipaddress.ip_address(address)
    except ValueError:  # with a zone: only valid on this very link
        return False
    return not (parsed.is_loopback or parsed.is_unspecified or parsed.is_link_local)
