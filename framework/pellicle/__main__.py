"""``python -m pellicle``: the command line."""

from __future__ import annotations

from .cli.app import app


def main() -> None:
    """Run the command line."""
    app(prog_name="pellicle")


if __name__ == "__main__":
    main()
