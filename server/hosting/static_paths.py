"""Where the files that this program serves lie."""

from __future__ import annotations

from pathlib import Path

import plotly

WEB = Path(__file__).resolve().parents[2] / "web"
"""Folder of the page: beside this package, in a checkout and in an installed wheel alike."""
PLOTLY = Path(plotly.__file__).parent / "package_data" / "plotly.min.js"
"""Plotly's own bundle, as its Python package brings it."""
