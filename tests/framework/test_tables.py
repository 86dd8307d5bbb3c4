"""The tables of runs and studies as text; ``python tests/framework/test_tables.py`` writes them."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

import pellicle as pl
from pellicle.config.describe import table_of
from pellicle.results import step_tables
from pellicle.results.dimensions import with_paths
from pellicle.show import tables
from pellicle.show.numbers import text_of

FILE = Path(__file__).with_suffix(".txt")
RUN: dict[str, Any] = {
    "title": "not an input",
    "grid": {"points": 16, "size": "0.4 mm"},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "30 mN/m"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": ["10 um", "20 um"], "stiffness": True},
    "corrections": [{"type": "yastrebov"}],
    "outputs": [],
}
STICKING = RUN | {
    "grid": {"points": 24, "size": "20 um"},
    "kernel": {"type": "half_space", "reduced_modulus": "10 kPa"},
    "indenter": {"type": "paraboloid", "radius": "20 um"},
    "interaction": {"type": "linear", "work_of_adhesion": "0.5 mJ/m^2", "range": "0.3 um"},
    "loading": {"depth": {"start": "-0.5 um", "stop": "0.2 um", "num": 3, "back": True}},
}
OSCILLATING = RUN | {
    "kernel": {
        "type": "viscoelastic",
        "solid": {"type": "half_space", "reduced_modulus": "10 kPa"},
        "relaxation": [{"fraction": 0.5, "time": "1 s"}],
    },
    "loading": {
        "depth": [
            {"to": "10 um", "time": "1 s", "num": 1},
            {"amplitude": "1 um", "frequency": "1 Hz", "cycles": 1, "num": 8},
        ]
    },
}
SHAPES = [{"type": "paraboloid", "radius": "1 mm"}, {"type": "cone", "half_angle": "85 degree"}]
STUDY = RUN | {
    "loading": {"depth": ["10 um", "20 um"]},
    "solver": {"type": "conjugate_gradient", "tolerance": 1e-12},
    "study": {
        "vary": {"solver.max_iterations": [2, 1000], "indenter": SHAPES},
        "derived": {"pull": "force / contact_area"},
    },
}
STICKING_STUDY = STICKING | {
    "study": {
        "vary": {"interaction.work_of_adhesion": ["0.5 mJ/m^2", "0.35 mJ/m^2"]},
        "derived": {"twice": "2 * pull_off"},
    }
}


def of_run(run: dict[str, Any], console: Console) -> Iterator[str]:
    """Yield the tables of a run but those of its effort and inputs, the main ones also in SI."""
    data = pl.run(run, progress=False, threads=1).dataset
    # It differs between machines.
    data["iterations"][:] = 7
    for si in (False, True):
        steps = step_tables.main_steps(data), step_tables.contact(data)
        shown = [*steps, *tables.path(data, si=si)]
        for table in (*shown, *tables.oscillations(data), *tables.all_steps(data)[: 2 * (not si)]):
            yield f"{table.caption}\n{text_of(table, console, si=si)}"


def of_study(study: dict[str, Any], console: Console) -> Iterator[str]:
    """Yield the tables of a study."""
    table = with_paths(pl.run_study(study, progress=False, threads=1))
    axes = table_of(tables.inputs_of_study(table, ()))
    main = tables.main_runs(table), *tables.main_paths(table)
    for shown in (*main, tables.runs(table), *tables.paths_of_runs(table), axes):
        yield f"{shown.caption}\n{text_of(shown, console)}"


def text() -> str:
    """Return all tables."""
    console = Console(file=io.StringIO(), width=100_000)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        parts = [part for run in (RUN, STICKING, OSCILLATING) for part in of_run(run, console)]
        parts += [part for study in (STUDY, STICKING_STUDY) for part in of_study(study, console)]
    # The names of files are hashes of all that determines a run.
    return re.sub(r"\b[0-9a-f]{8}…", "#", "\n".join(parts))


@pytest.mark.slow
def test_tables() -> None:
    """Numbers have one unit in a column and digits that tell them apart; texts are in words."""
    assert text() == FILE.read_text(encoding="utf-8"), f"if that is right: python {__file__}"


def test_the_path_has_the_prefix_of_the_steps() -> None:
    """Forces of nN are read in µN beside a step that has some."""
    with pytest.warns(pl.ConvergenceWarning):
        data = pl.run(STICKING, progress=False, threads=1).dataset.copy(deep=True)
    data["force"][0] = 5e-6
    (events,) = tables.path(data)
    rows = dict(zip(events.columns[0].values, events.columns[1].values, strict=True))
    assert rows["pull-off force"] == "-0.05322 µN"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
