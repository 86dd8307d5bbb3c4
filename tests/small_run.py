"""A run of three steps that takes a few milliseconds."""

from __future__ import annotations

from typing import Any

import pellicle as pl

RUN: dict[str, Any] = {
    "grid": {"points": 20, "size": "0.4 mm"},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "1 N/m"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": ["5 um", "10 um", "15 um"]},
    "outputs": [],
}


def run_file(study: str = "", **changes: Any) -> str:
    """Return the run, with changes, as the text of a TOML file, with the tables of a study."""
    return f"{pl.Run(**RUN | changes).to_toml()}\n{study}"
