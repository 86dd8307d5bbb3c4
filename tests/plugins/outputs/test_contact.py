"""What outputs that look at contact leave behind; what those that draw studies show and refuse."""

import base64
import json
import struct
import zlib
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree as Xml

import numpy as np
import pytest
import tomli_w
import xarray as xr

import pellicle as pl
from pellicle.components import Chart, Table
from pellicle.results import StoredRuns
from pellicle.show import up_to_rim
from pellicle_axisymmetric.indentation import indent
from pellicle_plugins.indenters.of_revolution import Paraboloid
from pellicle_plugins.outputs.curves import Curves
from pellicle_plugins.outputs.profiles import Profiles
from pellicle_plugins.outputs.spectrum import Spectrum
from pellicle_plugins.outputs.step_figures import profile
from tests.command import call
from tests.plugins.outputs.shared import bead, rows
from tests.tables_of_runs import half_space, paraboloid, pressing, self_affine, tensed

OUTPUTS = [
    {"type": "patches", "by": "step"},
    {"type": "distributions", "by": "step", "bins": 20},
    {"type": "spectrum", "by": "step"},
    {"type": "vtk"},
]
ROUGH: dict[str, Any] = bead(
    title="rough",
    grid={"points": [32, 24], "size": ["1 mm", "0.75 mm"], "boundary": "periodic"},
    indenter=self_affine("10 um", 0.5, "0.15 mm", seed=2),
    loading={"mean_pressure": ["50 Pa", "100 Pa"]},
    outputs=OUTPUTS,
)

Left = tuple[Path, pl.Result]


@pytest.fixture(scope="module")
def left(tmp_path_factory: pytest.TempPathFactory) -> Left:
    """Return the folder of a rough contact of two steps, and its result."""
    folder = tmp_path_factory.mktemp("rough")
    return folder, pl.run(ROUGH, directory=folder, progress=False, threads=1)


def column(table: list[dict[str, str]], name: str) -> np.ndarray:
    """Return a column of numbers."""
    return np.array([float(row[name]) for row in table])


def test_patches_and_pressures_carry_the_force(left: Left) -> None:
    """Areas and forces of patches sum to those of their step; densities integrate to 1 and F."""
    folder, result = left
    for step in range(2):
        data = result.dataset.isel(step=step)
        table = rows(folder / "rough-patches.csv", step=str(step + 1))
        assert len(table) == data["patches"].item() > 1
        area = column(table, "area [m2]")
        assert area.sum() == pytest.approx(data["contact_area"].item(), rel=1e-12)
        assert (np.diff(area) <= 0).all()
        force = column(table, "force [N]")
        assert force.sum() == pytest.approx(data["force"].item(), rel=1e-12)
        assert (force > 0).all()
        curve = {"curve": f"step = {step + 1}", "series": "pressure"}
        table = rows(folder / "rough-distributions.csv", **curve)
        share = column(table, "density") * (column(table, "upper") - column(table, "lower"))
        assert share.sum() == pytest.approx(1, rel=1e-12)
        mean = data["contact_area"].item() * (share @ column(table, "mean"))
        assert mean == pytest.approx(data["force"].item(), rel=1e-12)


def test_spectrum_holds_the_roughness(left: Left) -> None:
    """The indenter's sums to its mean square, the same at each step; the surface's to its own."""
    folder, result = left
    for step in range(2):
        for series, expected in (
            ("indenter", 10e-6**2),
            ("displacement", result.dataset["displacement"][step].values.var()),
        ):
            table = rows(folder / "rough-spectrum.csv", curve=f"step = {step + 1}", series=series)
            power = column(table, "density [m4]") @ column(table, "wave_vectors")
            assert power / result.grid.area == pytest.approx(expected, rel=1e-9)


def test_round_off_does_not_set_the_scale_of_a_spectrum(left: Left) -> None:
    """Beyond its shortest wave the indenter has round-off alone, which is not drawn."""
    _, result = left
    output = Spectrum()
    (_, table), (_, chart) = output.charts(StoredRuns.of_run(result.dataset))
    assert isinstance(chart, Chart)
    assert isinstance(table, Table)
    written = np.array(table.columns[3].values)
    assert written.min() < 1e-20 * written.max()
    drawn = np.concatenate([series.y for series in chart.series])
    assert drawn.min() > 1e-20 * drawn.max()


def decoded(array: Xml.Element) -> np.ndarray:
    """Return the values of a DataArray: base64 of a head of sizes, then of a compressed block."""
    text = (array.text or "").encode()
    one, size, last, packed = struct.unpack("<4Q", base64.b64decode(text[:44]))
    data = base64.b64decode(text[44:])
    assert (one, last, packed) == (1, 0, len(data))
    block = zlib.decompress(data)
    assert len(block) == size
    kinds = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}
    return np.frombuffer(block, kinds[array.attrib["type"]])


def test_vtk_holds_surface_and_fields(left: Left) -> None:
    """Points are the cell centres at minus the displacement, and the list names the steps."""
    folder, result = left
    listed = Xml.parse(folder / "rough.pvd").iter("DataSet")
    files = [(entry.attrib["timestep"], entry.attrib["file"]) for entry in listed]
    assert files == [("1", "rough-0001.vts"), ("2", "rough-0002.vts")]
    for step, (_, name) in enumerate(files):
        data = result.dataset.isel(step=step)
        root = Xml.parse(folder / name).getroot()
        assert root.attrib["byte_order"] == "LittleEndian"
        piece = next(root.iter("Piece"))
        assert piece.attrib["Extent"] == "0 31 0 23 0 0"
        arrays = {entry.attrib["Name"]: decoded(entry) for entry in root.iter("DataArray")}
        x, y, z = arrays["Points"].reshape(24, 32, 3).transpose(2, 1, 0)
        assert np.array_equal(x[:, 5], data["x"])
        assert np.array_equal(y[5], data["y"])
        assert np.array_equal(z, -data["displacement"])
        for field in ("pressure", "displacement", "gap", "contact"):
            assert np.array_equal(arrays[field].reshape(24, 32).T, data[field])
        assert arrays["force"] == data["force"].item()


def grids(*points: int) -> dict[str, Any]:
    """Return a study of nested grids, on which 2 + h^1.5 is extrapolated."""
    cell = "grid.size.0 / grid.points"
    curves = {"type": "curves", "x": cell, "y": f"2 + ({cell})**1.5", "extrapolate": True}
    plan = {"vary": {"grid.points": list(points)}}
    return bead(loading={"depth": "20 um"}, outputs=[curves], study=plan)


def test_curves_are_extrapolated(tmp_path: Path) -> None:
    """The limit at cell size zero and the exponent are in the table of the figure."""
    pl.run_study(grids(8, 10, 12, 16), tmp_path, progress=False, threads=1)
    *points, limit = rows(tmp_path / "study-curves.csv")
    assert [row["x"] for row in points] == [str(0.4e-3 / n) for n in (8, 10, 12, 16)]
    assert limit["series"].endswith(", extrapolated")
    assert float(limit["x"]) == 0
    assert float(limit["y"]) == pytest.approx(2, rel=1e-9)
    assert float(limit["exponent"]) == pytest.approx(1.5, rel=1e-4)
    assert limit["converged"] == "True"


def test_two_grids_are_not_extrapolated(tmp_path: Path) -> None:
    """The message says how many are needed."""
    with pytest.raises(pl.ConfigError, match=r"extrapolate: 2 values of x.*at least 3"):
        pl.run_study(grids(8, 16), tmp_path, progress=False, threads=1)


RADIUS, MODULUS, DEPTH, SIZE = 1e-3, 10e3, 50e-6, 0.8e-3


@pytest.mark.parametrize("tension", [0.0, 0.1, 1.0])
@pytest.mark.parametrize("points", [64, 81])
def test_the_line_is_the_solution(tension: float, points: int) -> None:
    """Up to the rim it is within 3 % of the highest pressure, where single cells miss by 80 %."""
    result = pl.run(
        pressing(points, SIZE, tensed(MODULUS, tension), paraboloid(RADIUS), depth=DEPTH)
        | {"corrections": [{"type": "yastrebov"}]},
        progress=False,
    )
    series = profile(result).series[0]
    exact = indent(Paraboloid(radius=RADIUS), MODULUS, tension, depth=DEPTH)
    a, highest = exact.contact_radius, series.y.max()
    rim = series.x[series.y > 0].max()
    assert rim == pytest.approx(a, abs=0.2 * SIZE / points)
    y = result.grid.coordinates()[1][0, points // 2]
    inside = np.abs(series.x) < 0.99 * a
    r = np.hypot(series.x[inside], y)
    np.testing.assert_allclose(series.y[inside], exact.pressure(r), atol=0.03 * highest)
    np.testing.assert_array_equal(series.y[np.abs(series.x) > rim * (1 + 1e-9)], 0.0)
    # The line falls at the rim itself.
    np.testing.assert_array_equal(np.diff(series.x) >= 0, True)
    assert (np.diff(series.x) == 0).sum() == 2
    # Marks beside the solution are those of the cells that the line keeps.
    runs = StoredRuns.of_run(result.dataset)
    numbers, chart = (part for _, part in Profiles(reference="axisymmetric").charts(runs))
    assert isinstance(chart, Chart)
    marks, solution = chart.series
    expected = np.interp(marks.x, solution.x, solution.y)
    np.testing.assert_allclose(marks.y, expected, atol=0.03 * highest)
    assert marks.x.size > 50
    assert isinstance(numbers, Table)
    assert [*numbers.columns[1].values].count("run") == points


def test_an_elliptic_contact_has_a_rim() -> None:
    """Hertz's pressure along both axes of an ellipse, p₀ √(1 − x²/a²)."""
    quadric = {"type": "quadric", "radius_x": "1 mm", "radius_y": "3 mm"}
    result = pl.run(pressing(96, SIZE, half_space(MODULUS), quadric, depth=30e-6), progress=False)
    series = profile(result).series[0]
    minor = float(result.dataset["semi_minor_axis"][0])
    inside = np.abs(series.x) < 0.98 * minor
    hertz = series.y.max() * np.sqrt(1 - (series.x[inside] / minor) ** 2)
    np.testing.assert_allclose(series.y[inside], hertz, atol=0.02 * series.y.max())


@pytest.mark.parametrize(
    ("contact", "pressure"),
    [
        ("...#####.....", "falls"),
        (".....##################...####....", "falls"),
        ("...##################........", "falls"),
        ("....####################....", "rises"),
    ],
    ids=["few cells", "two parts", "beside the middle", "a punch"],
)
def test_elsewhere_the_line_goes_through_the_cells(contact: str, pressure: str) -> None:
    """Coarse contacts, several, shifted ones and pressures that grow to the rim are left alone."""
    mask: Any = np.array([cell == "#" for cell in contact])
    x: Any = np.arange(mask.size) - (mask.size - 1) / 2
    half = mask.sum() / 2
    root = np.sqrt(np.clip(1 - (x / half) ** 2, 0.0, None))
    values: Any = np.where(mask, root if pressure == "falls" else 2 - root, 0.0)
    line = up_to_rim(x, values, mask, half)
    np.testing.assert_array_equal(line[0], x)
    np.testing.assert_array_equal(line[1], values)


TENSION, TIP = "kernel.tension", "indenter.radius"


def study(*outputs: dict[str, Any] | pl.Output) -> dict[str, Any]:
    """Return a small study of two tensions, two radii and two steps."""
    plan = {"vary": {TENSION: [0.0, 1.0], TIP: ["1 mm", "2 mm"]}}
    return bead(outputs=list(outputs), study=plan, loading={"depth": ["10 um", "15 um"]})


def carried(folder: Path, *outputs: dict[str, Any] | pl.Output) -> xr.Dataset:
    """Return the table of the study, its outputs left in the folder."""
    return pl.run_study(study(*outputs), folder, progress=False, threads=1)


def test_curves_are_mean_and_range_of_the_table(tmp_path: Path) -> None:
    """One curve for each tension, its points means over the radii, with lowest and highest."""
    curves = {"type": "curves", "x": "depth", "y": "force", "by": TENSION, "over": TIP}
    table = carried(tmp_path, curves)
    table_rows = rows(tmp_path / "study-curves.csv")
    for name, expected in (
        ("y", table["force"].mean("indenter_radius")),
        ("y_lowest", table["force"].min("indenter_radius")),
        ("y_highest", table["force"].max("indenter_radius")),
    ):
        drawn = [float(row[name]) for row in table_rows]
        np.testing.assert_allclose(drawn, expected.values.ravel(), rtol=1e-14)


def test_the_spread_may_be_a_deviation(tmp_path: Path) -> None:
    """The standard deviation of the runs, of n − 1, and over √n that of their mean."""
    curves = {"type": "curves", "by": TENSION, "over": TIP}
    table = carried(
        tmp_path,
        {**curves, "name": "std", "spread": "std"},
        {**curves, "name": "sem", "spread": "sem"},
    )
    deviation = table["force"].std("indenter_radius", ddof=1).values.ravel()
    for name, expected in (("std", deviation), ("sem", deviation / np.sqrt(2))):
        drawn = rows(tmp_path / f"study-{name}.csv")
        half = [float(row["y_highest"]) - float(row["y"]) for row in drawn]
        np.testing.assert_allclose(half, expected, rtol=1e-9)
        assert {row["spread"] for row in drawn} == {name}


def test_curves_of_a_study_of_one_axis_need_no_by(tmp_path: Path) -> None:
    """Each value has its own curve over the steps; of an x that is the axis, each step has."""
    plan = study({"type": "curves"}, {"type": "curves", "name": "over", "x": TENSION})
    plan["study"]["vary"].pop(TIP)
    pl.run_study(plan, tmp_path, progress=False, threads=1)
    assert [row["curve"] for row in rows(tmp_path / "study-curves.csv")] == [
        *2 * ["kernel.tension = 0 N/m"],
        *2 * ["kernel.tension = 1 N/m"],
    ]
    assert [row["x"] for row in rows(tmp_path / "study-over.csv")] == 2 * ["0.0", "1.0"]


def test_fields_of_one_run_of_a_study_say_which(tmp_path: Path) -> None:
    """Without by it is the first value of each axis that is shown, and named."""
    carried(tmp_path, {"type": "distributions"})
    shown = {row["curve"] for row in rows(tmp_path / "study-distributions.csv")}
    assert shown == {"kernel.tension = 0 N/m, indenter.radius = 1 mm"}


class Failing(pl.Output):
    """Finds out too late that it cannot show a study."""

    type: Literal["failing"] = "failing"

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
        raise pl.ConfigError("is not what it seemed", "type")


def test_an_output_that_fails_keeps_no_other_from_drawing(tmp_path: Path) -> None:
    """The one that fails is named by its place among the outputs."""
    distributions = {"type": "distributions", "by": TENSION}
    with pytest.warns(UserWarning, match=r"^outputs\.1\.type: is not what it"):
        table = carried(tmp_path, {"type": "maps"}, Failing(), distributions)
    assert table["converged"].all()
    assert (tmp_path / "study-distributions.png").exists()


def shown(**curves: Any) -> Chart:
    """Return the curves of a study of three axes, of 2, 3 and 2 values, and two steps."""
    plan = {"indenter.radius": [1e-3, 2e-3], TENSION: [0.0, 0.01, 1.0], "indenter.centre.0": [0, 1]}
    axes = {name: (name, values, {"units": "N/m"}) for name, values in plan.items()}
    table = xr.Dataset(coords=axes | {"step": [1, 2]})
    shape = 2, 3, 2, 2
    columns = {"force": np.arange(24.0).reshape(shape), "converged": np.ones(shape, bool)}
    columns |= {"depth": np.broadcast_to([1.0, 2.0], shape), "status": np.full(shape, "")}
    table = table.assign({name: ((*plan, "step"), column) for name, column in columns.items()})
    table = table.assign(run=(tuple(plan), np.full(shape[:-1], "a")))
    table.attrs = {"configuration": "{}", "axes": json.dumps([*plan])}
    ((_, chart),) = Curves(**curves).charts(StoredRuns(table, lambda name: table))
    assert isinstance(chart, Chart)
    return chart


def test_two_axes_have_colours_and_markers_and_others_panels() -> None:
    """No two curves of a panel look alike, and all looks are in the legend."""
    chart = shown(by=[TIP, TENSION])
    assert [title.split()[-2] for title in chart.titles] == ["0", "1"]
    curves = [one for one in chart.series if one.x.size]
    assert len({(one.panel, one.look.hue, one.look.line, one.look.marker) for one in curves}) == 12
    assert len({one.key for one in curves}) == 12
    assert curves[2].y.tolist() == [8.0, 9.0]
    assert [one.legend.split()[1] for one in chart.series if one.legend] == [
        "1",
        "2",
        "0",
        "0.01",
        "1",
    ]


def test_an_axis_is_shown_at_one_value() -> None:
    """The value has a unit; without `by` the first axis has colours, the next panels."""
    chart = shown(where={TENSION: "10 mN/m"})
    assert [one.y.tolist() for one in chart.series if not one.panel] == [[4.0, 5.0], [16.0, 17.0]]
    for where, message in (
        ({TENSION: "15 mN/m"}, "no value of kernel.tension, which has 0, 0.01, 1 N/m"),
        ({TENSION: "1 m"}, "kernel.tension: '1 m' is in m"),
        ({"step": 1}, "'step' is not an axis"),
    ):
        with pytest.raises(pl.ConfigError, match=message):
            shown(where=where)


def test_what_cannot_be_drawn_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message says which axis there is, and nothing is solved before."""
    monkeypatch.chdir(tmp_path)
    curves = {"type": "curves", "where": {TENSION: "2 N/m"}}
    plan = study({"type": "maps", "name": "good"}, curves)
    (tmp_path / "plan.toml").write_text(tomli_w.dumps(plan), encoding="utf-8")
    with pytest.raises(pl.ConfigError, match=r"^outputs\.1\.where: .*which has 0, 1 N/m"):
        pl.run_study(plan, tmp_path, progress=False)
    for command in (["run", "--dry-run"], ["check"]):
        assert "outputs.1" in call(*command, "plan.toml", code=2).output
    assert not list(tmp_path.rglob("*.h5"))


def test_a_number_that_the_reference_lacks_is_refused_at_once(tmp_path: Path) -> None:
    """The semi-analytic solution knows no iterations."""
    curves = {"type": "curves", "y": "iterations", "by": TENSION, "reference": "axisymmetric"}
    with pytest.raises(pl.ConfigError, match=r"^outputs\.0\.y: 'iterations' has no value in"):
        pl.run_study(study(curves), tmp_path, progress=False)


def test_fields_are_reduced_for_each_run(tmp_path: Path) -> None:
    """An expression over fields gives the number of each step."""
    curves = {"type": "curves", "x": "depth", "y": "sum(pressure)", "by": TENSION, "over": TIP}
    table = carried(tmp_path, curves)
    drawn = [float(row["y"]) * (0.4e-3 / 16) ** 2 for row in rows(tmp_path / "study-curves.csv")]
    force = table["force"].mean("indenter_radius").values.ravel()
    np.testing.assert_allclose(drawn, force, rtol=1e-12)


def test_a_run_of_fewer_steps_is_drawn_at_its_last(tmp_path: Path) -> None:
    """Each run of a study is shown at its own last step, however many steps the others have."""
    configuration = study({"type": "profiles", "y": "pressure", "by": "loading.depth"})
    configuration["study"] = {"vary": {"loading.depth": [["10 um"], ["10 um", "15 um"]]}}
    pl.run_study(configuration, tmp_path, progress=False, threads=1)
    assert len({row["curve"] for row in rows(tmp_path / "study-profiles.csv")}) == 2
