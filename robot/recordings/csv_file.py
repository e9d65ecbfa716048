"""Columns of numbers in a text file: comma, semicolon, tab or blanks between them."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import IO

import numpy as np

from slidetune.robot.recordings.limits import MOST_COLUMNS, MOST_ROWS
from slidetune.robot.recordings.refused import RecordingError, quoted

Array = np.ndarray

_CHUNK = 4000
"""Rows that are read at a time (*ours*)."""
_LONGEST_LINE = 200_000
"""Most characters of a line (*ours*)."""
_COMMENT = "#"
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?(?:nan|inf(?:inity)?)", re.I)
_COMMA_NUMBER = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
_NO_VALUE = ("", "nan", "na", "n/a", "null", "none", "-")


class CsvFile:
    """A text file of columns.

    Attributes:
        names: header of every column; ``column 1`` and so on where there is none.
        rows_are: what a row is called.
    """

    rows_are = "line"

    def __init__(self, path: Path) -> None:
        """Read the header and see how columns are parted.

        Raises:
            RecordingError: if there is no table in it.
        """
        self._path = path
        with self._open() as file:
            header, first = self._beginning(file)
        self._separator = _separator(header, first)
        cells = [_decoded(cell).strip() for cell in self._cells(header)]
        if not cells[-1] and len(cells) > 1:
            cells = cells[:-1]
        if len(cells) < 2:
            raise RecordingError(
                f"has a single column, {quoted(cells[0])}: part the columns by commas, semicolons, "
                "tabs or blanks",
                row=self._header_row,
            )
        if len(cells) > MOST_COLUMNS:
            raise RecordingError(
                f"has {len(cells)} columns, at most {MOST_COLUMNS} are read", row=self._header_row
            )
        values = self._cells(first)
        self._comma = self._separator != "," and any(map(_COMMA_NUMBER.fullmatch, values))
        self._headless = all(_is_number(cell, self._separator != ",") for cell in cells)
        self.names = tuple(
            f"column {number}" if self._headless or not cell else cell
            for number, cell in enumerate(cells, 1)
        )

    def read(self, wanted: Sequence[int]) -> tuple[Array, Array]:
        """Return some of the columns, and the number of each row in the file.

        Args:
            wanted: numbers of the columns, from 0.

        Returns:
            Numbers, NaN for an empty cell, shape (n, k), and lines, shape (n,).

        Raises:
            RecordingError: naming row, column and value of what is no number.
        """
        blocks: list[Array] = []
        places: list[Array] = []
        count = 0
        with self._open() as file:
            for numbers, lines in self._chunks(file):
                count += len(lines)
                if count > MOST_ROWS:
                    raise RecordingError(
                        f"has more than {MOST_ROWS:,} rows: cut it, or write every tenth row"
                    )
                blocks.append(self._block(numbers, lines, wanted))
                places.append(np.array(numbers))
        if not blocks:
            return np.empty((0, len(wanted))), np.empty(0, int)
        return np.concatenate(blocks), np.concatenate(places)

    def _open(self) -> IO[str]:
        # Latin-1 takes every byte: columns that nobody reads may hold anything.
        return self._path.open(encoding="latin-1")

    def _beginning(self, file: IO[str]) -> tuple[str, str]:
        """Return the header and the first line behind it."""
        header, self._header_row = "", 0
        for number, line in enumerate(islice(file, 10_000), 1):
            _check_length(line, number)
            text = line.removeprefix("\xef\xbb\xbf") if number == 1 else line
            if not text.strip():
                continue
            if text.lstrip().startswith(_COMMENT):
                # A comment right above the numbers is their header, as NumPy writes it.
                header, self._header_row = text.lstrip().lstrip(_COMMENT).strip() + "\n", number
                self._begin = number + 1
                continue
            if header and self._header_row == number - 1 and _all_numbers(text):
                return header, text
            if header and not header.startswith("\0"):
                header = ""
            return self._behind(file, text, number)
        raise RecordingError("has no rows: a header and at least eight rows are needed")

    def _behind(self, file: IO[str], header: str, row: int) -> tuple[str, str]:
        self._header_row, self._begin = row, row + 1
        if _all_numbers(header):
            self._begin = row
            return header, header
        for number, line in enumerate(islice(file, 10_000), row + 1):
            _check_length(line, number)
            if line.strip():
                return header, line
        raise RecordingError("has a header and no rows", row=row)

    def _chunks(self, file: IO[str]) -> Iterator[tuple[list[int], list[str]]]:
        numbers: list[int] = []
        lines: list[str] = []
        for number, line in enumerate(file, 1):
            if number < self._begin or not line.strip() or line.lstrip().startswith(_COMMENT):
                continue
            numbers.append(number)
            lines.append(line)
            if len(lines) == _CHUNK:
                yield numbers, lines
                numbers, lines = [], []
        if lines:
            yield numbers, lines

    def _block(self, numbers: list[int], lines: list[str], wanted: Sequence[int]) -> Array:
        """Return the numbers of some lines: at once where all is well, else cell by cell."""
        if all(self._count(line) == len(self.names) and '"' not in line for line in lines):
            text = [line.replace(",", ".") for line in lines] if self._comma else lines
            try:
                return np.loadtxt(
                    text, delimiter=self._separator, usecols=wanted, ndmin=2, comments=None
                )
            except ValueError:
                pass
        return np.array(
            [self._row(number, line, wanted) for number, line in zip(numbers, lines, strict=True)]
        )

    def _count(self, line: str) -> int:
        if self._separator is None:
            return len(line.split())
        return line.count(self._separator) + 1

    def _row(self, number: int, line: str, wanted: Sequence[int]) -> list[float]:
        _check_length(line, number)
        cells = self._cells(line)
        if len(cells) == len(self.names) + 1 and not cells[-1].strip():
            cells = cells[:-1]
        if len(cells) != len(self.names):
            raise self._wrong_count(number, cells)
        return [self._value(cells[column], number, column) for column in wanted]

    def _cells(self, line: str) -> list[str]:
        if self._separator is None:
            return line.split()
        try:
            return next(csv.reader([line.rstrip("\r\n")], delimiter=self._separator), [""])
        except csv.Error as error:
            raise RecordingError(f"a line can't be parted into columns: {error}") from error

    def _value(self, cell: str, row: int, column: int) -> float:
        text = cell.strip()
        if text.lower() in _NO_VALUE:
            return np.nan
        if self._comma:
            text = text.replace(",", ".")
        if not _NUMBER.fullmatch(text):
            raise RecordingError(
                f"{quoted(_decoded(cell.strip()))} is no number{_hint(text)}",
                row=row,
                column=self.names[column],
                value=_decoded(cell.strip())[:100],
            )
        return float(text)

    def _wrong_count(self, row: int, cells: list[str]) -> RecordingError:
        hint = "a line may be cut off, or two run into each other"
        if self._separator == "," and len(cells) > len(self.names):
            hint = (
                "where numbers have a decimal comma, part the columns by semicolons or write "
                "decimal points"
            )
        text = f"has {len(cells)} cells where the header has {len(self.names)}: {hint}"
        return RecordingError(text, row=row)


def _check_length(line: str, number: int) -> None:
    if len(line) > _LONGEST_LINE:
        text = f"is longer than {_LONGEST_LINE:,} characters: this is no table"
        raise RecordingError(text, row=number)


def _decoded(text: str) -> str:
    """Return what was read as Latin-1 as UTF-8 where it is that."""
    try:
        return text.encode("latin-1").decode("utf-8")
    except UnicodeDecodeError:
        return text


def _separator(header: str, first: str) -> str | None:
    for separator in (";", "\t", ","):
        if separator in header or (separator in first and separator != ","):
            return separator
    return None


def _all_numbers(line: str) -> bool:
    separator = _separator(line, line)
    cells = line.split() if separator is None else line.strip().rstrip(separator).split(separator)
    return len(cells) > 1 and all(_is_number(cell, separator != ",") for cell in cells)


def _is_number(cell: str, comma: bool) -> bool:
    text = cell.strip()
    return bool(_NUMBER.fullmatch(text) or (comma and _COMMA_NUMBER.fullmatch(text)))


def _hint(text: str) -> str:
    if re.match(r"\d{4}-\d\d-\d\d", text):
        return ": write time in seconds, not as a date"
    if text.lower() in ("true", "false"):
        return ": map another column"
    return ": correct it, take the row out, or map another column"
