"""Outcomes of a benchmark of fits, kept in a file as they come, and its command line."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any


def outcomes_of(
    description: str | None,
    kinds: Sequence[str],
    curves: int,
    outcome: Callable[[str, int, int], dict[str, Any]],
) -> tuple[int, dict[str, list[dict[str, Any]]]]:
    """Return the number of curves that the command line names, and outcomes by kind.

    ``outcome`` returns that of a kind, a number of a curve and a seed, as JSON data.  Outcomes that
    the file of ``--keep`` has are not repeated, and others are appended to it.
    """
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("curves", type=int, nargs="?", default=curves)
    parser.add_argument("seed", type=int, nargs="?", default=7)
    parser.add_argument("names", nargs="*", metavar="kind")
    parser.add_argument("--keep", type=Path, help="file that keeps the outcomes")
    options = parser.parse_args()
    names = options.names or kinds
    known: dict[tuple[str, int], dict[str, Any]] = {}
    if options.keep is not None and options.keep.exists():
        for line in options.keep.read_text().splitlines():
            name, number, seed, values = json.loads(line)
            if seed == options.seed:
                known[name, number] = values
    for number in range(options.curves):
        for name in names:
            if (name, number) in known:
                continue
            known[name, number] = values = outcome(name, number, options.seed)
            if options.keep is not None:
                with options.keep.open("a") as lines:
                    print(json.dumps([name, number, options.seed, values]), file=lines)
    return options.curves, {
        name: [known[name, number] for number in range(options.curves)] for name in names
    }
