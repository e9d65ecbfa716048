"""What a browser keeps of the page, and what it asks for again."""

from __future__ import annotations

import asyncio
import re
import shutil
from pathlib import Path

import httpx
from fastapi import FastAPI

from slidetune.server.hosting.page_files import serve_page
from slidetune.server.hosting.static_paths import WEB


class Served:
    """A folder of the page, served within this process."""

    def __init__(self, web: Path = WEB) -> None:
        self._app = FastAPI()
        serve_page(self._app, web)

    def get(self, address: str) -> httpx.Response:
        async def ask() -> httpx.Response:
            transport = httpx.ASGITransport(self._app)
            async with httpx.AsyncClient(transport=transport, base_url="http://here") as client:
                return await client.get(address)

        return asyncio.run(ask())

    def named(self) -> list[str]:
        """Return the addresses of the files that the page names."""
        page = self.get("/")
        assert page.headers["cache-control"] == "no-cache"
        return re.findall(r'(?:href|src)="(/static/[^"]+)"', page.text)


def test_every_file_that_the_page_names_is_kept_and_is_the_one_of_the_folder() -> None:
    served = Served()
    addresses = served.named()
    assert len(addresses) > 20
    for address in addresses:
        answer = served.get(address)
        assert answer.status_code == 200
        assert "immutable" in answer.headers["cache-control"]
        plain = served.get(re.sub("^/static/[0-9a-f]+/", "/static/", address))
        assert plain.headers["cache-control"] == "no-cache"
        assert plain.content == answer.content


def test_a_file_that_changes_or_comes_gives_every_file_another_address(tmp_path: Path) -> None:
    web = tmp_path / "web"
    shutil.copytree(WEB, web)
    seen = [Served(web).named()]
    (web / "api" / "api.js").write_text("// changed\n", encoding="utf-8")
    seen.append(Served(web).named())
    (web / "another.js").touch()
    seen.append(Served(web).named())
    assert len({address for addresses in seen for address in addresses}) == sum(map(len, seen))


def test_what_no_version_has_is_not_there() -> None:
    served = Served()
    assert served.get("/static/0123456789abcdef/main.js").status_code == 404
    assert served.get(served.named()[0].rsplit("/", 1)[0] + "/none.js").status_code == 404
