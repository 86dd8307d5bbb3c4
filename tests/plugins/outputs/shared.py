"""The run whose outputs are looked at, and the tables that they leave."""

import csv
from pathlib import Path
from typing import Any

from tests.tables_of_runs import paraboloid, pressing, tensed

PUNCH = {"type": "flat_punch", "radius": "0.1 mm"}


def bead(**changes: Any) -> dict[str, Any]:
    """Return a run of two steps under a paraboloid, with some of its tables replaced."""
    skin, depths = tensed("10 kPa", "10 mN/m"), ["5 um", "10 um"]
    return pressing(16, "0.4 mm", skin, paraboloid("1 mm"), depth=depths) | changes


def rows(path: Path, **which: str) -> list[dict[str, str]]:
    """Return the rows of a table, those that have these texts."""
    with path.open(newline="", encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if which.items() <= row.items()]
