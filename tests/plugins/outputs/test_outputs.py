"""The files of each output."""

from __future__ import annotations

import csv
import re
import zlib
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_hex

import pellicle as pl
from tests.pictures import drawn_width, pixels

BLUE, ORANGE = "#0072b2", "#d55e00"
FIGURES = {
    "pressure": set[str](),
    "profile": {BLUE, ORANGE},
    "force_depth": {BLUE},
    "area_force": {BLUE, ORANGE},
}
"""The colours of the lines in each figure."""


def _run(outputs: list[Any] | None, **changes: Any) -> pl.Run:
    return pl.Run(
        **{
            "title": "Two Steps",
            "grid": {"points": 16, "size": "0.4472 mm"},
            "kernel": {"type": "half_space", "reduced_modulus": "10 kPa"},
            "indenter": {"type": "paraboloid", "radius": "1 mm"},
            "loading": {"depth": ["5 um", "10 um"]},
            "corrections": [{"type": "yastrebov"}],
            "outputs": outputs,
            **changes,
        }
    )


def _read_csv(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_csv(tmp_path: Path) -> None:
    """The table has units in its header and the result's numbers in one row a step."""
    result = pl.run(_run([{"type": "csv"}]), directory=tmp_path, progress=False)
    rows = _read_csv(tmp_path / "two-steps.csv")
    assert [row["step"] for row in rows] == ["1", "2"]
    for header in ("depth [m]", "force [N]", "contact_area [m2]", "contact_area_yastrebov [m2]"):
        name = header.partition(" ")[0]
        written = [float(row[header]) for row in rows]
        assert written == list(result.dataset[name].values)
    assert [row["status"] for row in rows] == ["converged", "converged"]
    assert [row["converged"] for row in rows] == ["True", "True"]
    assert {"mean_pressure [Pa]", "contact_fraction", "iterations", "wall_time [s]"} <= set(rows[0])


def test_csv_starts_afresh(tmp_path: Path) -> None:
    """A second run replaces the table of the first."""
    for _ in range(2):
        pl.run(_run([{"type": "csv"}]), directory=tmp_path, progress=False)
    assert len(_read_csv(tmp_path / "two-steps.csv")) == 2


def test_csv_goes_on_below_the_header_that_is_there(tmp_path: Path) -> None:
    """Steps of an earlier version, which had fewer columns, do not move those of the later ones."""
    result = pl.run(_run([]), progress=False)
    output = _run([{"type": "csv"}]).outputs[0]  # type: ignore[index]
    stem = tmp_path / "steps"
    output.step(result.dataset.isel(step=[0]).drop_vars(["patches", "perimeter"]), stem)
    output.step(result.dataset.isel(step=[1]), stem)
    rows = _read_csv(tmp_path / "steps.csv")
    assert [float(row["force [N]"]) for row in rows] == list(result.dataset["force"].values)
    assert [row["status"] for row in rows] == ["converged", "converged"]


def test_csv_holds_every_finished_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that is interrupted leaves the rows of the steps before."""
    from pellicle.runs import steps

    _interrupt_in_step(2, monkeypatch, steps)
    with pytest.raises(KeyboardInterrupt):
        pl.run(_run([{"type": "csv"}]), directory=tmp_path, progress=False)
    assert len(_read_csv(tmp_path / "two-steps.csv")) == 1


def _interrupt_in_step(step: int, monkeypatch: pytest.MonkeyPatch, module: Any) -> None:
    solve, calls = module.solve_step, []

    def solve_or_interrupt(*arguments: Any) -> Any:
        calls.append(arguments)
        if len(calls) == step:
            raise KeyboardInterrupt
        return solve(*arguments)

    monkeypatch.setattr(module, "solve_step", solve_or_interrupt)


def _line_colours(path: Path) -> set[str]:
    """Return the colours of the lines in a figure: of PNG those of all pixels."""
    if path.suffix == ".png":
        return {to_hex(tuple(pixel)) for pixel in np.unique(pixels(path).reshape(-1, 3), axis=0)}
    if path.suffix == ".svg":
        return set(re.findall(r"(?<=stroke: )#\w{6}", path.read_text(encoding="utf-8")))
    streams = re.findall(rb"(?s)stream\n(x.*?)\nendstream", path.read_bytes())
    content = b"\n".join(zlib.decompressobj().decompress(stream) for stream in streams)
    strokes = re.findall(rb"([\d.]+)\s([\d.]+)\s([\d.]+)\sRG\b", content)
    return {to_hex((float(stroke[0]), float(stroke[1]), float(stroke[2]))) for stroke in strokes}


@pytest.mark.slow
@pytest.mark.parametrize("format_", ["png", "svg", "pdf"])
def test_figures(tmp_path: Path, format_: str) -> None:
    """Every figure is drawn in the format that is asked for."""
    outputs = [{"type": "figures", "formats": [format_]}]
    pl.run(_run(outputs), directory=tmp_path, progress=False)
    figures = [tmp_path / f"two-steps-{figure}.{format_}" for figure in FIGURES]
    assert {*tmp_path.iterdir()} == {*figures, tmp_path / "two-steps.h5"}
    for figure, colours in FIGURES.items():
        assert colours <= _line_colours(tmp_path / f"two-steps-{figure}.{format_}")
    if format_ == "png":
        # The contact is half as wide as the panel; right of it is the bar of colours.
        assert 0.3 < drawn_width(tmp_path / "two-steps-pressure.png", columns=(0, 0.75)) < 0.6


@pytest.mark.parametrize(
    "changes",
    [
        {"loading": {"depth": 0}},
        {
            "grid": {"points": [1, 8], "size": "0.4 mm", "boundary": "periodic"},
            "indenter": {"type": "flat_punch", "radius": "0.1 mm"},
        },
        {"indenter": {"type": "flat_punch", "radius": "0.1 mm"}},
    ],
    ids=["no contact", "one cell across", "punch with nothing beside it"],
)
def test_figures_of_odd_results(tmp_path: Path, changes: dict[str, Any]) -> None:
    """Results without contact, without width or with infinite gaps are drawn as well."""
    outputs = [{"type": "figures"}]
    pl.run(_run(outputs, **changes), directory=tmp_path, progress=False)
    assert len(list(tmp_path.glob("*.png"))) == len(FIGURES)


def test_figures_have_units(tmp_path: Path) -> None:
    """The axes of the curves carry real units."""
    outputs = [{"type": "figures", "formats": ["svg"]}]
    import matplotlib as mpl

    with mpl.rc_context({"svg.fonttype": "none"}):
        from matplotlib.figure import Figure

        from pellicle import plotting

        result = pl.run(_run(outputs), progress=False, directory=tmp_path)
        axes = Figure().add_subplot()
        plotting.force_depth(result, axes)
    assert axes.get_xlabel() == "depth [µm]"
    assert axes.get_ylabel() == "force [µN]"
    assert np.asarray(axes.lines[0].get_xdata()) == pytest.approx([5.0, 10.0])


EVERYTHING: list[dict[str, Any]] = [
    {"type": "csv"},
    {"type": "figures"},
    {"type": "maps"},
    {"type": "maps", "formats": ["svg"]},
    {"type": "maps", "name": "gap"},
    *({"type": type_} for type_ in ("curves", "profiles", "patches", "spectrum")),
    *({"type": type_} for type_ in ("distributions", "vtk", "html")),
]
WITH_NUMBERS = "curves", "profiles", "patches", "spectrum", "distributions"
NAMES = {
    *(".h5", ".csv", ".html", ".pvd", "-0001.vts", "-0002.vts"),
    *("-maps.png", "-maps.svg", "-gap.png"),
    *(f"-{type_}.{suffix}" for type_ in WITH_NUMBERS for suffix in ("png", "csv")),
}
OF_RUNS = {".h5", ".csv", ".pvd", "-0001.vts", "-0002.vts"}


@pytest.mark.slow
def test_names_of_files(tmp_path: Path) -> None:
    """Every output writes files of the names that users know."""
    pl.run(_run(EVERYTHING), directory=tmp_path, progress=False)
    names = {path.name.removeprefix("two-steps") for path in tmp_path.iterdir()}
    assert names == NAMES | {f"-{figure}.png" for figure in FIGURES}


@pytest.mark.slow
def test_names_of_files_of_a_study(tmp_path: Path) -> None:
    """The table and the figures lie in the folder of a study, what shows single runs in runs."""
    study = pl.Study(run=_run(EVERYTHING), vary={"indenter.radius": [1e-3, 2e-3]})
    table = pl.run_study(study, tmp_path, progress=False)
    names = {path.name.removeprefix("study") for path in tmp_path.glob("study*")}
    of_study = NAMES - OF_RUNS | {".h5", ".csv"}
    assert names == of_study | {"-force.png", "-contact_area.png"}
    runs = {path.name for path in (tmp_path / "runs").iterdir()}
    assert runs == {f"{run}{suffix}" for run in table["run"].values for suffix in OF_RUNS}


def test_any_run_leaves_its_result(tmp_path: Path) -> None:
    """The file holds the very result that the run returned, whichever outputs are named."""
    for number, outputs in enumerate(([], [{"type": "csv"}])):
        folder = tmp_path / str(number)
        result = pl.run(_run(outputs), directory=folder, progress=False)
        names = {path.suffix for path in folder.iterdir()}
        assert names == {".h5", *(f".{one['type']}" for one in outputs)}
        xr.testing.assert_identical(pl.load(folder / "two-steps.h5").dataset, result.dataset)


def test_result_is_whole_after_each_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """While a step is solved, the file with those before it can be read."""
    from pellicle.runs import steps

    counts: list[int] = []
    solve = steps.solve_step

    def look_and_solve(*arguments: Any) -> Any:
        path = tmp_path / "two-steps.h5"
        counts.append(pl.load(path).dataset.sizes["step"] if path.exists() else 0)
        return solve(*arguments)

    monkeypatch.setattr(steps, "solve_step", look_and_solve)
    run = _run([], loading={"depth": ["6 um", "8 um", "10 um"]})
    pl.run(run, directory=tmp_path, progress=False)
    assert counts == [0, 1, 2]


def test_result_replaces_its_own_only(tmp_path: Path) -> None:
    """The same run may be repeated; another one only replaces it when told to."""
    run = _run([])
    for _ in range(2):
        pl.run(run, directory=tmp_path, progress=False)
    other = _run([], loading={"depth": ["7 um"]})
    with pytest.raises(pl.StorageError, match=r"another configuration.*--overwrite"):
        pl.run(other, directory=tmp_path, progress=False)
    assert pl.load(tmp_path / "two-steps.h5").dataset.sizes["step"] == 2
    pl.run(other, directory=tmp_path, progress=False, overwrite=True)
    assert pl.load(tmp_path / "two-steps.h5").dataset.sizes["step"] == 1


class Recording(pl.Output):
    """Keeps the steps that it is given, and fails at the end of the first run."""

    type: Literal["recording"] = "recording"
    seen: ClassVar[list[tuple[int, str]]] = []

    def step(self, record: xr.Dataset, stem: Path) -> None:
        """Keep the number of the step."""
        self.seen.append((record["step"].item(), stem.name))

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
        """Write nothing."""
        return ()


def test_steps_come_once_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of an earlier process come first, with the stem of the output."""
    from pellicle.runs import steps

    monkeypatch.setattr(Recording, "seen", [])
    run = _run([Recording()])
    with monkeypatch.context() as context:
        _interrupt_in_step(2, context, steps)
        with pytest.raises(KeyboardInterrupt):
            pl.run(run, directory=tmp_path, progress=False)
    assert Recording.seen == [(1, "two-steps-recording")]
    Recording.seen.clear()
    pl.run(run, directory=tmp_path, progress=False)
    assert [number for number, _ in Recording.seen] == [1, 2]


def test_a_folder_that_cannot_be_written_is_known_before_solving(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The message has the name of the file and what to do."""
    from pellicle.runs import steps

    monkeypatch.setattr(steps, "solve_step", None)
    (tmp_path / "file").write_text("in the way")
    message = r"two-steps.*cannot be written.*choose another folder"
    with pytest.raises(pl.StorageError, match=message):
        pl.run(_run([]), directory=tmp_path / "file" / "folder", progress=False)


def test_library_writes_nothing_unasked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A library call without a folder or outputs leaves no file."""
    monkeypatch.chdir(tmp_path)
    choices: tuple[list[dict[str, Any]] | None, ...] = (None, [])
    for outputs in choices:
        pl.run(_run(outputs), progress=False)
    assert list(tmp_path.iterdir()) == []


def test_steps_of_a_longer_run_do_not_stay(tmp_path: Path) -> None:
    """Files of steps that a run does not have would belong to the one that it replaces."""
    run = {
        "title": "s",
        "grid": {"points": 16, "size": "0.4 mm"},
        "kernel": {"type": "half_space", "reduced_modulus": "10 kPa"},
        "indenter": {"type": "paraboloid", "radius": "1 mm"},
        "outputs": [{"type": "vtk"}],
    }
    other = tmp_path / "s-0003-0001.vts"
    other.touch()
    for depths in (["10 um", "12 um"], ["14 um"]):
        loaded = run | {"loading": {"depth": depths}}
        pl.run(loaded, directory=tmp_path, progress=False, overwrite=True)
    assert {*tmp_path.glob("*.vts")} == {tmp_path / "s-0001.vts", other}
