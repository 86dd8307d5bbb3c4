"""What a long fit shows on a terminal: which parameter it is at."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

Report = Callable[[str], None]
"""Takes a few words on what a fit is doing."""


def ignore(_: str) -> None:
    """Show nothing."""


@contextmanager
def status(enabled: bool) -> Iterator[Report]:
    """Show a line on a terminal for as long as the context lasts; nothing without a terminal."""
    from rich.console import Console

    console = Console(stderr=True)
    if not (enabled and console.is_terminal):
        yield ignore
        return
    with console.status("fitting") as line:
        yield lambda words: line.update(f"fitting: {words}")
