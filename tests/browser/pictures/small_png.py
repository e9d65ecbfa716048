"""Pictures small enough for a repository: as many colours as a screen of text and lines has."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

from PIL import Image

LARGEST = 150_000
"""Most bytes of a picture."""
COLOURS = (256, 128, 64, 32)


def write_small(png: bytes, path: Path) -> int:
    """Write a picture with the most colours that keep it small; return its bytes.

    Raises:
        ValueError: if it is too large with the fewest.
    """
    picture = Image.open(BytesIO(png)).convert("RGB")
    for colours in COLOURS:
        with BytesIO() as buffer:
            # Colours that are rare count as well: those of lanes are.
            few = picture.quantize(
                colours, Image.Quantize.MAXCOVERAGE, kmeans=2, dither=Image.Dither.NONE
            )
            few.save(buffer, "PNG", optimize=True)
            small = buffer.getvalue()
        if len(small) <= LARGEST:
            path.write_bytes(small)
            return len(small)
    raise ValueError(f"{path.name} has {len(small)} bytes with {colours} colours: take less of it")
