"""A view as plain text, for a terminal and for whoever reads a notebook's file."""

from __future__ import annotations

from slidetune.server.notebook.view import Table, View


def text_form(view: View) -> str:
    """Return lines of text."""
    return "\n".join([view.title, *view.notes, *(_table(table) for table in view.tables)])


def _table(table: Table) -> str:
    rows = [table.headings, *table.rows]
    widths = [max(len(row[place]) for row in rows) for place in range(len(table.headings))]

    def line(row: tuple[str, ...]) -> str:
        cells = [
            text.ljust(width) if table.words or not place else text.rjust(width)
            for place, (text, width) in enumerate(zip(row, widths, strict=True))
        ]
        return "  ".join(cells).rstrip()

    return "\n".join([*([table.caption] if table.caption else []), *map(line, rows)])
