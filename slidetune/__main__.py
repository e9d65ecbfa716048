"""The command line; ``python -m slidetune`` without more serves the dashboard."""

from __future__ import annotations

from slidetune.server.cli import main

if __name__ == "__main__":  # worker processes import this module under another name
    main()
