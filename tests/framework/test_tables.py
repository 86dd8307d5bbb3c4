"""The tables of runs, studies and inputs; ``python tests/framework/test_tables.py`` writes two."""

import io
import json
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

import pellicle as pl
from pellicle.config.describe import FieldRow, inputs, table_of
from pellicle.results import step_tables
from pellicle.results.dimensions import with_paths
from pellicle.show import tables
from pellicle.show.numbers import text_of
from pellicle.units import readable
from tests.tables_of_runs import coated, half_space, layer, paraboloid, pressing, relaxing, tensed

FILE = Path(__file__).with_suffix(".txt")
DEPTHS: dict[str, Any] = {"depth": ["10 um", "20 um"], "stiffness": True}
RUN = pressing(16, "0.4 mm", tensed("10 kPa", "30 mN/m"), paraboloid("1 mm"), **DEPTHS) | {
    "title": "not an input",
    "corrections": [{"type": "yastrebov"}],
    "outputs": [],
}
BACK = {"start": "-0.5 um", "stop": "0.2 um", "num": 3, "back": True}
STICKING = RUN | pressing(24, "20 um", half_space("10 kPa"), paraboloid("20 um"), depth=BACK)
STICKING["interaction"] = {"type": "linear", "work_of_adhesion": "0.5 mJ/m^2", "range": "0.3 um"}
OSCILLATING = RUN | {
    "kernel": relaxing(half_space("10 kPa"), 0.5, "1 s"),
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


CONFIGURATION: dict[str, Any] = {
    "title": "µ",
    "grid": {"points": [16, 12], "size": ["0.4 mm", "0.3 mm"]},
    "kernel": coated(layer("frictionless_layer", "0.1 mm", 0.3, youngs_modulus=1e4), "0.2 N/m"),
    "indenter": {"type": "cone", "half_angle": "70 degree"},
    "loading": {"depth": {"start": "1 um", "stop": "20 um", "num": 20}},
    "corrections": [{"type": "yastrebov"}],
    "outputs": [{"type": "curves", "published": [{"label": "a", "x": [3, 4], "y": [1, 2]}]}],
}


@pytest.fixture(scope="module")
def table() -> dict[str, FieldRow]:
    """Return the inputs of a run by their names."""
    data = json.loads(pl.Run(**CONFIGURATION).to_json())
    return {entry.name: entry for entry in inputs(data, pl.Run)}


def test_values_have_units(table: dict[str, FieldRow]) -> None:
    """Of components within components and of lists too; a long list is shortened, and says so."""
    for name, value in {
        "grid.points": "16, 12",
        "grid.size": "400, 300 µm",
        "grid.boundary": "free",
        "kernel": "coated",
        "kernel.tension": "200 mN/m",
        "kernel.substrate": "frictionless layer",
        "kernel.substrate.thickness": "100 µm",
        "kernel.substrate.youngs_modulus": "10 kPa",
        "indenter.half_angle": "70°",
        "loading.depth": "1, 2, 3, 4, 5, 6, …, 20 µm (20 values)",
        "solver.tolerance": "1e-08",
        "corrections.0": "Yastrebov",
        "outputs.0.published.0.y": "1, 2",
    }.items():
        assert table[name].value == value


def test_inputs_are_explained(table: dict[str, FieldRow]) -> None:
    """Every one of them says what it means, and components where they come from."""
    assert all(entry.meaning for entry in table.values())
    origin = table["kernel.substrate"].origin
    assert origin is not None
    assert origin.entry_point == "kernel.frictionless_layer"
    assert origin.version == pl.__version__
    components = {"kernel", "kernel.substrate", "indenter", "solver", "corrections.0", "outputs.0"}
    assert {name for name, entry in table.items() if entry.origin} == components


def test_what_nobody_explains_is_there() -> None:
    """A component that is not installed here is listed with its bare numbers."""
    data = {"kernel": {"type": "of_a_stranger", "stiffness": 3.0, "stops": [{"at": 1}]}}
    assert [(entry.name, entry.value, entry.meaning) for entry in inputs(data, pl.Run)] == [
        ("kernel", "of a stranger", ""),
        ("kernel.stiffness", "3", ""),
        ("kernel.stops.0.at", "1", ""),
    ]


@pytest.mark.parametrize(
    ("value", "unit", "words"),
    [
        (0.0, "m", "0 m"),
        (True, "1", "True"),
        ([], "m", ""),
        ("any text", "m", "any text"),
        (12345678, "1", "12345678"),
        ([1e-6, 2e-3], "N", "0.001, 2 mN"),
        # A prefix is raised with the unit that it stands before: 10 nm² is 1e-17 m².
        (1e-8, "m**2", "0.01 mm²"),
        ([1e-12, 4e-12], "m2", "1, 4 µm²"),
        (2e-11, "N*m", "20 pN·m"),
        (9e7, "Pa/m", "90 MPa/m"),
        (3e-24, "m4", "3e-24 m⁴"),
        (5e6, "1/m", "5e+06 1/m"),
    ],
)
def test_readable(value: Any, unit: str, words: str) -> None:
    """Numbers get a prefix; what is no number is as it is."""
    assert readable(value, unit) == words
