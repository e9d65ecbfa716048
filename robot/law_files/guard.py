"""What a law's own file is given before it is run: an end to each of its loops.

A compiled law holds the interpreter's lock, so that nothing in the process could end one that never
returns. So each loop counts its turns, in compiled code and in plain Python alike, and raises when
there are too many. That is the same on every machine, however fast or busy it is.
"""

from __future__ import annotations

import ast
from typing import TypeVar

from slidetune.robot.law_files.refused import LawFileError

MOST_TURNS = 100_000
"""Turns that the loops of one call of a function may take together (*ours*): a hundred times what
there is time for in a control period of 1 ms."""
ENDLESS = "__EndlessLoopError__"
"""Global of the module by which its loops know ``EndlessLoopError``."""
_TURNS = "__turns__"
_TEXT = f"the loops of one call took more than {MOST_TURNS} turns, which are the most allowed"

Block = TypeVar("Block", ast.Module, ast.FunctionDef, ast.AsyncFunctionDef)


class EndlessLoopError(Exception):
    """A loop of a law's own file that was ended."""


def guarded(text: str, path: str, file: str) -> ast.Module:
    """Return the tree of a law's own file whose loops have an end.

    Args:
        text: what is in it.
        path: under which it is run.
        file: its name.

    Raises:
        SyntaxError: if it is no Python.
        LawFileError: if a function of it calls itself: compiled, it could end the process.
    """
    tree = ast.parse(text, path)
    _refuse_recursion(tree, file)
    _Ends().visit(_counting(tree))
    return ast.fix_missing_locations(tree)


def _counting(block: Block) -> Block:
    """Let a module or a function begin to count."""
    begin = ast.parse(f"{_TURNS} = 0").body[0]
    first = next(
        (place for place, one in enumerate(block.body) if not _stays_first(one)), len(block.body)
    )
    at = block.body[first] if first < len(block.body) else block.body[-1] if block.body else begin
    block.body.insert(first, _placed(begin, at))
    return block


def _stays_first(statement: ast.stmt) -> bool:
    """Whether a statement must stay before all others: a docstring, an import of the future."""
    if isinstance(statement, ast.ImportFrom):
        return statement.module == "__future__"
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


class _Ends(ast.NodeTransformer):
    """Puts the counter into every function and loop."""

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """Let a function count its loops' turns."""
        self.generic_visit(node)
        return _counting(node)

    def visit_AsyncFunctionDef(self, node: ast.AsyncFunctionDef) -> ast.AST:
        """Do the same."""
        self.generic_visit(node)
        return _counting(node)

    def visit_While(self, node: ast.While) -> ast.AST:
        """Let a loop end."""
        return self._ended(node)

    def visit_For(self, node: ast.For) -> ast.AST:
        """Let a loop end."""
        return self._ended(node)

    def _ended(self, node: ast.While | ast.For) -> ast.AST:
        self.generic_visit(node)
        code = f"{_TURNS} += 1\nif {_TURNS} > {MOST_TURNS}:\n    raise {ENDLESS}({_TEXT!r})"
        node.body[:0] = [_placed(one, node) for one in ast.parse(code).body]
        return node


def _placed(new: ast.stmt, at: ast.AST) -> ast.stmt:
    """Give new code the place of what it belongs to, so that a traceback shows that."""
    for one in ast.walk(new):
        if "lineno" in one._attributes:
            ast.copy_location(one, at)
            one.end_lineno = one.lineno  # type: ignore[attr-defined]
            one.end_col_offset = one.col_offset  # type: ignore[attr-defined]
    return new


def _refuse_recursion(tree: ast.Module, file: str) -> None:
    functions = {one.name: one for one in tree.body if isinstance(one, ast.FunctionDef)}
    calls = {
        name: {
            call.func.id
            for call in ast.walk(one)
            if isinstance(call, ast.Call)
            and isinstance(call.func, ast.Name)
            and call.func.id in functions
        }
        for name, one in functions.items()
    }
    for name, one in functions.items():
        reached, new = set[str](), calls[name]
        while new:
            reached |= new
            new = set[str]().union(*(calls[other] for other in new)) - reached
        if name in reached:
            text = f"line {one.lineno}: {name} calls itself: write a loop instead"
            raise LawFileError(file, text)
