"""A run of three steps that takes a few milliseconds."""

from typing import Any

import pellicle as pl
from tests.tables_of_runs import paraboloid, pressing, tensed

RUN: dict[str, Any] = pressing(
    20, "0.4 mm", tensed("10 kPa", "1 N/m"), paraboloid("1 mm"), depth=["5 um", "10 um", "15 um"]
) | {"outputs": []}


def run_file(study: str = "", **changes: Any) -> str:
    """Return the run, with changes, as the text of a TOML file, with the tables of a study."""
    return f"{pl.Run(**RUN | changes).to_toml()}\n{study}"
