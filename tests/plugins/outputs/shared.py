"""The run whose outputs are looked at, and the tables that they leave."""

import csv
from pathlib import Path
from typing import Any

PUNCH = {"type": "flat_punch", "radius": "0.1 mm"}


def bead(**changes: Any) -> dict[str, Any]:
    """Return a run of two steps under a paraboloid, with some of its tables replaced."""
    return {
        "grid": {"points": 16, "size": "0.4 mm"},
        "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "10 mN/m"},
        "indenter": {"type": "paraboloid", "radius": "1 mm"},
        "loading": {"depth": ["5 um", "10 um"]},
        **changes,
    }


def rows(path: Path, **which: str) -> list[dict[str, str]]:
    """Return the rows of a table, those that have these texts."""
    with path.open(newline="", encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if which.items() <= row.items()]
