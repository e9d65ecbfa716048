"""The site, for the tests that look at it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.docs.built import Html, built_once, html_pages


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the built site."""
    return built_once(tmp_path_factory)


@pytest.fixture(scope="session")
def built(site: Path) -> dict[str, Html]:
    """Return every page of the site by its name."""
    return {page.path.relative_to(site).as_posix(): page for page in html_pages(site)}
