"""Which addresses are printed: those by which others reach this machine, also offline."""

from __future__ import annotations

import ipaddress
import socket
from typing import Any

import pytest

from slidetune.server.guard.access_policy import AccessPolicy
from slidetune.server.guard.own_addresses import own_addresses

EVERYWHERE = ["", "0.0.0.0", "::"]


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "192.168.1.5", "::1", "lab-pc"])
def test_a_server_bound_to_one_address_is_reached_by_that(host: str) -> None:
    assert own_addresses(host) == [host]


@pytest.mark.parametrize("host", EVERYWHERE)
def test_this_machine_is_named_last_and_no_address_is_useless_to_others(host: str) -> None:
    *addresses, name = own_addresses(host)
    assert name == socket.gethostname()
    for address in addresses:
        parsed = ipaddress.ip_address(address)
        useless = (parsed.is_loopback, parsed.is_unspecified, parsed.is_link_local)
        assert not any(useless), address
    assert len(set(addresses)) == len(addresses)


def offline(*_: object, **__: object) -> Any:
    raise OSError(101, "Network is unreachable")


@pytest.mark.parametrize("host", EVERYWHERE)
def test_offline_the_name_is_left(host: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(socket.socket, "connect", offline)
    monkeypatch.setattr(socket, "getaddrinfo", offline)
    assert own_addresses(host) == [socket.gethostname()]
    address = AccessPolicy(host, 8000, "t", "v").address()
    assert address == f"http://{socket.gethostname()}:8000/?token=t"


def test_without_a_route_the_names_own_addresses_stand_in(monkeypatch: pytest.MonkeyPatch) -> None:
    def known(*_: object, **__: object) -> list[Any]:
        found = ["127.0.1.1", "169.254.3.4", "192.168.1.5", "192.168.1.5"]
        pairs: list[Any] = [(socket.AF_INET, 2, 17, "", (address, 0)) for address in found]
        return [*pairs, (socket.AF_INET6, 2, 17, "", ("fd00::5", 0, 0, 0))]

    monkeypatch.setattr(socket.socket, "connect", offline)
    monkeypatch.setattr(socket, "getaddrinfo", known)
    name = socket.gethostname()
    assert own_addresses("0.0.0.0") == ["192.168.1.5", name]
    assert own_addresses("::") == ["192.168.1.5", "fd00::5", name]


def test_every_address_of_a_role_carries_its_token() -> None:
    policy = AccessPolicy("0.0.0.0", 8000, "mine", "theirs")
    hosts = own_addresses("0.0.0.0")
    assert policy.addresses("owner") == [f"http://{host}:8000/?token=mine" for host in hosts]
    assert policy.addresses("viewer") == [f"http://{host}:8000/?token=theirs" for host in hosts]
