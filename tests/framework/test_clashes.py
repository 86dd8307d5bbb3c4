"""Outputs that would write the same files."""

from __future__ import annotations

from typing import Any, Literal

import pytest

import pellicle as pl
from pellicle.components import Output
from pellicle.config.output_conflicts import matches, refuse_clashes
from pellicle.plugins import registry

RUN: dict[str, Any] = {
    "grid": {"points": 16, "size": "1 mm"},
    "kernel": {"type": "half_space", "reduced_modulus": "10 kPa"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": "10 um"},
}


class Silent(pl.Output):
    """Says nothing of its files."""

    type: Literal["silent"] = "silent"


class Named(Silent):
    """Says nothing either, but has a name."""

    name: str = ""


class Plain(Silent):
    """Writes what the table of numbers is."""

    def endings(self) -> tuple[str, ...]:
        """Return one that csv has."""
        return "-more.txt", ".csv"


class OfStudies(Plain):
    """Is called by studies."""

    def study(self, place: pl.Place, table: Any) -> tuple[Any, ...]:
        """Leave nothing."""
        return ()


class Fields(Silent):
    """Writes a file of its own for all fields."""

    def endings(self) -> tuple[str, ...]:
        """Return that of the result."""
        return (".h5",)


def make_output(type_: str, **fields: Any) -> Output:
    """Return a built-in output."""
    return registry().make(Output, {"type": type_, **fields})


@pytest.mark.parametrize(
    ("outputs", "message"),
    [
        (
            [make_output("maps", name="pressure"), make_output("figures")],
            r"^outputs\.0\.name: 'maps' would write NAME-pressure\.png, as outputs\.1 \('figures'\)"
            r" does; give it another name$",
        ),
        (
            [make_output("figures"), make_output("curves", name="force")],
            r"^outputs\.1\.name: 'curves' would write NAME-force\.png, as outputs\.0 \('figures'\)",
        ),
        (
            [make_output("csv"), make_output("hdf5"), Plain()],
            r"^outputs\.2\.type: 'silent' would write NAME\.csv, as outputs\.0 \('csv'\) does; "
            "leave one out$",
        ),
        (
            [make_output("curves", name="a", formats=["svg"]), make_output("profiles", name="A")],
            r"^outputs\.1\.name: 'profiles' would write NAME-A\.csv, as outputs\.0",
        ),
        ([Silent(), Silent()], r"^outputs\.1\.type: 'silent' would write NAME-silent\*, as"),
        (
            [Named(name="a"), Named(), Named(name="a")],
            r"^outputs\.2\.name: .* NAME-a\*, as outputs\.0",
        ),
        (
            [Silent(), make_output("spectrum", name="silent")],
            r"^outputs\.1\.name: 'spectrum' would write NAME-silent\.png, as outputs\.0",
        ),
    ],
)
def test_outputs_of_one_file_are_refused(outputs: list[Output], message: str) -> None:
    """The message has both outputs, the file, and the field to change: a name if there is one."""
    with pytest.raises(pl.ConfigError, match=message):
        pl.Run(**RUN, outputs=outputs)


def test_outputs_that_share_no_file() -> None:
    """Every built-in output stands beside all others, and one type twice by name or by format."""
    every = [make_output(type_) for type_ in registry().components["output"]]
    refuse_clashes(
        [*every, make_output("maps", name="gap"), make_output("maps", formats=["pdf"]), Silent()]
    )


@pytest.mark.parametrize(
    ("output", "message"),
    [
        (OfStudies(), r"outputs\.1\.type: 'silent' would write study\.csv, the table of the study"),
        (Fields(), r"outputs\.1\.type: 'silent' would write NAME\.h5, the result that each run"),
    ],
)
def test_what_a_study_writes_itself_is_not_replaced(output: Output, message: str) -> None:
    """An output alone in a run is refused in a study whose own files it would replace."""
    run = RUN | {"outputs": [make_output("figures"), output]}
    pl.Run(**run)
    with pytest.raises(pl.ConfigError, match=message):
        pl.Study(run=run, vary={"indenter.radius": [1e-3, 2e-3]})


def test_standard_outputs_in_a_study() -> None:
    """Its own table does not clash with the results and tables of its runs."""
    run = RUN | {
        "outputs": [make_output(type_) for type_ in ("hdf5", "csv", "figures", "html", "vtk")]
    }
    pl.Study(run=run, vary={"indenter.radius": [1e-3, 2e-3]})


@pytest.mark.parametrize(
    ("ending", "told", "same"),
    [
        (".csv", ".csv", True),
        ("-0003.vts", "-*.vts", True),
        ("-Gap.png", "-gap.png", True),
        ("-gap.csv", ".csv", False),
        ("-0003.vtk", "-*.vts", False),
    ],
)
def test_endings_are_compared(ending: str, pattern: str, same: bool) -> None:
    """By the whole ending, with * for anything and whatever the case."""
    assert matches(ending, pattern) is same
