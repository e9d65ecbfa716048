"""Runs a notebook: ``python -m tests.notebooks.execute NOTEBOOK EXECUTED``, in the present folder.

In a process of its own, as what talks to kernels leaves sockets to the garbage collector.
"""

from __future__ import annotations

import os
import sys

import nbformat
from jupyter_client.kernelspec import KernelSpec, KernelSpecManager
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient

PATIENCE = 600
"""Seconds that a cell may take before it counts as hung."""


class _ThisInterpreter(KernelSpecManager):
    """Knows one kernel: Python as it runs here, whatever is installed elsewhere."""

    def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
        """Return how it is started."""
        command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        return KernelSpec(argv=command, display_name="Python 3", language="python")


def execute(source: str, target: str) -> None:
    """Run all cells and write the notebook with its outputs; raises what a cell raises."""
    notebook = nbformat.read(source, as_version=4)  # type: ignore[no-untyped-call]
    manager = AsyncKernelManager(kernel_spec_manager=_ThisInterpreter())
    client = NotebookClient(notebook, km=manager, timeout=PATIENCE)
    client.execute(env=dict(os.environ))
    nbformat.write(notebook, target)  # type: ignore[no-untyped-call]


if __name__ == "__main__":
    execute(*sys.argv[1:])
