"""The studies of the paper's figures, smaller than they stand in docs/studies."""

import csv
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from images import compliance
from jsonschema import Draft202012Validator

import pellicle as pl
from pellicle.config.study import from_toml
from pellicle_axisymmetric.adhesive_contact import Adhesion
from pellicle_axisymmetric.indentation import indent
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.command import call
from tests.docs.blocks import ROOT

STUDIES = ROOT / "docs/studies"
RADIUS, MODULUS, DEPTH = 1e-3, 10e3, 50e-6
Rows = list[dict[str, str]]


def run(name: str, folder: Path, *overrides: str) -> None:
    """Carry out a study of docs/studies as a user would."""
    words = [word for text in overrides for word in ("--set", text)]
    call("run", STUDIES / name, "-o", folder, "--threads", "1", *words)


def drawn(path: Path, **which: str) -> Rows:
    """Return the numbers that a figure shows, of which only those with these texts."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return [row for row in rows if all(row[key] == value for key, value in which.items())]


def column(rows: Rows, name: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return a column of numbers."""
    assert rows
    return np.array([float(row[name]) for row in rows])


@pytest.mark.parametrize("path", sorted(STUDIES.glob("*.toml")), ids=lambda path: path.name)
def test_study_is_valid(path: Path) -> None:
    """Every file in docs/studies makes a run or a study, and the schema accepts it."""
    from_toml(path)
    Draft202012Validator(pl.json_schema()).validate(tomllib.loads(path.read_text("utf-8")))


def test_fig2_agreement_is_what_the_page_says() -> None:
    """The formula is the paper's, and the cells differ from it by the figure given, at most."""
    text = (ROOT / "docs/paper.md").read_text(encoding="utf-8")
    (figure,) = re.findall(r"a twelfth of the highest they agree within ([\d.]+) %", text)
    largest = 0.0
    for tension in compliance.TENSIONS:
        kernel = compliance.kernel_of(tension)
        q, cells = compliance.along_x(kernel, compliance.GRID)
        used = slice(9, int(np.searchsorted(q, q[-1] / 12, "right")))
        formula = 2 / (MODULUS * q + 2 * tension * q**2)
        np.testing.assert_allclose(kernel.compliance(q), formula, rtol=1e-12)
        largest = max(largest, float(np.abs(cells[used] / formula[used] - 1).max()))
    assert f"{100 * largest:.2f}" == figure


@pytest.mark.slow
def test_fig3_the_correction_helps_on_every_grid(tmp_path: Path) -> None:
    """The counted area is 4 % off at N = 32, < 0.5 % beyond 256; the corrected one is nearer."""
    run("fig3.toml", tmp_path, 'study.vary={"grid.points"=[32,64,128,272]}')
    true = (
        np.pi
        * indent(Paraboloid(radius=RADIUS), MODULUS, 1.0, depth=DEPTH).contact_radius ** 2
        * 1e6
    )
    path = tmp_path / "study-curves.csv"
    counted, corrected = (
        abs(column(drawn(path, series=series), "y") / true - 1)
        for series in ("without correction", "with correction")
    )
    np.testing.assert_allclose(
        column(drawn(path, series="with correction, semi-analytic"), "y"), true, rtol=1e-9
    )
    assert (corrected < counted).all()
    assert counted[0] == pytest.approx(0.04, abs=0.005)
    assert counted[2] < 0.015
    assert counted[3] < 0.005
    assert corrected[2] < 0.006


@pytest.mark.slow
def test_fig4_pressure_is_the_semi_analytic_one(tmp_path: Path) -> None:
    """Inside the contact, three cells from its edge, the pressures agree to 2 %."""
    run("fig4.toml", tmp_path, "grid.points=64")
    rows = drawn(tmp_path / "study-profiles.csv")
    for name in dict.fromkeys(row["curve"] for row in rows):
        run_, true = (
            [row for row in rows if (row["curve"], row["series"]) == (name, series)]
            for series in ("run", "semi-analytic")
        )
        x, y = column(run_, "x"), column(run_, "y")
        inside = abs(x) < 0.8
        expected = np.interp(x[inside], column(true, "x"), column(true, "y"))
        np.testing.assert_allclose(y[inside], expected, rtol=0.02)
        assert (y[abs(x) > 1.1] == 0).all()


@pytest.mark.slow
def test_fig5_force_and_depth_follow_the_semi_analytic_solution(tmp_path: Path) -> None:
    """Both ratios over Hertz agree with the semi-analytic ones at the same s/a."""
    tensions = 'study.vary={"kernel.tension"=["10 mN/m", "0.1 N/m", "1 N/m"]}'
    run("fig5.toml", tmp_path, "grid.points=64", tensions)
    for name, tolerance in (("force", 0.02), ("depth", 0.02)):
        path = tmp_path / f"study-{name}.csv"
        curve = drawn(path, series="boundary elements")
        true = drawn(path, series="boundary elements, semi-analytic")
        for axis in ("x", "y"):
            np.testing.assert_allclose(column(curve, axis), column(true, axis), rtol=tolerance)
        assert (np.diff(column(curve, "y")) > 0).all()


@pytest.mark.slow
def test_fig6_the_ellipse_is_more_slender_with_tension(tmp_path: Path) -> None:
    """a₁/a₂ falls with tension; without it both semi-axes are those of Hertz."""
    run("fig6.toml", tmp_path, "grid.points=64")
    ratio = column(drawn(tmp_path / "study-slenderness.csv", curve=""), "y")
    assert (np.diff(ratio) < 0).all()
    path = tmp_path / "study-semi-axes.csv"
    spacing = 0.7 / 64
    for series, hertz in (("a₁", 0.210473), ("a₂", 0.333769)):
        assert abs(column(drawn(path, series=series), "y")[0] - hertz) < spacing / 2
    assert abs(ratio[0] - 0.210473 / 0.333769) < 0.005


def test_fig7_is_the_surface(tmp_path: Path) -> None:
    """The surface is drawn without a contact being solved."""
    run("fig7.toml", tmp_path, "grid.points=128", "indenter.cutoff_wavelength='0.125 mm'")
    step = xr.open_dataset(tmp_path / "fig7.h5", engine="h5netcdf").isel(step=0)
    assert step["operator_applications"].item() == step["contact_area"].item() == 0
    heights = (step["displacement"] - step["depth"] - step["gap"]).values
    assert heights.std() == pytest.approx(10e-6)
    assert heights.max() == pytest.approx(0.0, abs=0.01e-6)


@pytest.fixture(scope="module")
def rough(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a small figure 8 and, of the same runs, figure 9."""
    folder = tmp_path_factory.mktemp("rough")
    smaller = (
        "grid.points=64",
        "indenter.cutoff_wavelength='0.125 mm'",
        "loading.depth=['40 um','100 um']",
    )
    tensions = '"kernel.tension"=["0 mN/m","10 mN/m","50 mN/m","100 mN/m"]'
    axes = f'study.vary={{{tensions},"indenter.seed"=[0,1]}}'
    for name in ("fig8.toml", "fig9.toml"):
        run(name, folder, *smaller, axes)
    return folder


@pytest.mark.slow
def test_fig8_the_fraction_falls_with_tension(rough: Path) -> None:
    """At every depth and for every seed a higher tension makes a smaller contact."""
    table = xr.open_dataset(rough / "study.h5", engine="h5netcdf")
    for area in ("contact_area", "contact_area_yastrebov"):
        assert (table[area].diff("kernel_tension") < 0).all()
    path = rough / "study-curves.csv"
    for tension in ("0", "10", "50", "100"):
        curve = drawn(path, curve=f"τ₀ = {tension} mN/m", series="corrected")
        low, mean, high = (column(curve, name) for name in ("y_lowest", "y", "y_highest"))
        assert (low <= mean).all()
        assert (mean <= high).all()
        assert (column(curve, "runs") == 2).all()


@pytest.mark.slow
def test_fig9_a_fraction_needs_more_force_with_tension(rough: Path) -> None:
    """The mean pressure in contact, force over area, grows with the tension at every depth."""
    path = rough / "study-force.csv"
    pressures = [
        column(curve, "x") / column(curve, "y")
        for curve in (drawn(path, curve=f"τ₀ = {t} mN/m") for t in ("0", "10", "50", "100"))
    ]
    assert (np.diff(pressures, axis=0) > 0).all()


@pytest.mark.slow
def test_layers_a_stiff_film_counts_at_small_depths(tmp_path: Path) -> None:
    """Under the stiffest film the apparent modulus has a minimum, without one it only rises."""
    depths = 'loading.depth=["0.8 um", "1.6 um", "10 um"]'
    run("layers.toml", tmp_path, "grid.points=96", "grid.size='0.4 mm'", depths)
    path = tmp_path / "study-curves.csv"
    soft, stiff = (
        column(drawn(path, curve=f"film of {modulus} MPa"), "y") for modulus in ("0.01", "10")
    )
    assert (np.diff(soft) > 0).all()
    assert (soft > 40 / 3).all()
    assert stiff[1] < stiff[0] < stiff[2]
    assert (stiff > 1.5 * soft).all()


@pytest.mark.slow
def test_pull_off_goes_from_elastic_to_liquid(tmp_path: Path) -> None:
    """The bead pulls off at the force of the closed theory to 2 %, with and without tension."""
    vary = 'study.vary={"kernel.tension"=[0.0,0.02]}'
    run("pull_off.toml", tmp_path, "grid.points=96", vary)
    rows = drawn(tmp_path / "study-adhesive_curve-summary.csv")
    for row, tension in zip(rows, (0.0, 0.02), strict=True):
        theory = Adhesion(Paraboloid(radius=0.2e-3), 1e3, tension, 0.3e-3)
        force = float(row["pull_off_force [N]"])
        assert force == pytest.approx(float(theory.instability().force), rel=0.02)


@pytest.mark.slow
def test_a_thin_layer_is_harder_to_pull_off(tmp_path: Path) -> None:
    """The force grows as the layer gets thinner, towards that of separate springs, 2πwR."""
    vary = 'study.vary={"kernel.substrate.thickness"=[20e-6,500e-6]}'
    run("sticky_layer.toml", tmp_path, "grid.points=96", vary)
    thin, thick = column(drawn(tmp_path / "study-adhesive_curve-summary.csv"), "pull_off_force [N]")
    assert thin / thick > 1.1
    assert -2 < thin / (np.pi * 0.5e-3 * 0.2e-3) < thick / (np.pi * 0.5e-3 * 0.2e-3) < -1


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:of 2 runs, in 2 the cells are too coarse")
@pytest.mark.filterwarnings("ignore:of 2 runs, in 2 a part of the contact jumped")
def test_sticky_rough_punch_loses_more_energy_the_more_it_sticks(tmp_path: Path) -> None:
    """The loop of force and depth widens with the work of adhesion."""
    run(
        "sticky_rough_punch.toml",
        tmp_path,
        "grid.points=64",
        'loading.depth={start="-2 um", stop="2 um", num=9, back=true}',
        'study.vary={"interaction.work_of_adhesion"=["0.1 mJ/m^2", "0.5 mJ/m^2"]}',
    )
    with xr.open_dataset(tmp_path / "study.h5", engine="h5netcdf") as table:
        lost = table["dissipated_energy"].values
    assert 0 < 5 * lost[0] < lost[1]


@pytest.mark.slow
def test_loops_lose_most_at_the_time_of_the_relaxation(tmp_path: Path) -> None:
    """Much faster or slower than the gel relaxes the way back is nearly the way in."""
    steps = ["loading.depth.0.num=6", "loading.depth.1.num=6"]
    run("loops.toml", tmp_path, "grid.points=20", *steps)
    areas = []
    for name in ("0.01", "1", "100"):
        rows = drawn(tmp_path / "study-curves.csv", curve=f"{name} s each way")
        force, depth = column(rows, "y"), column(rows, "x")
        areas.append(float(np.trapezoid(force, depth)) / force.max())
        assert [rows[0]["direction"], rows[-1]["direction"]] == ["approach", "retraction"]
    assert areas[1] > 4 * areas[0]
    assert areas[1] > 2 * areas[2]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:kernel. the shares of 'coated' that relax sum to 1")
@pytest.mark.filterwarnings("ignore:of 1 runs, in 1 the contact jumps across")
def test_plateau_is_that_of_the_tension(tmp_path: Path) -> None:
    """The force of a bead at a contact radius ends at 2πτ₀a²/R, to 10 % on coarse cells."""
    run(
        "plateau.toml",
        tmp_path,
        "grid.points=48",
        'loading.contact_radius=[{to="80 um",time=0,num=1}, {hold="3 s",num=1}]',
        'kernel.substrate.relaxation=[{fraction=1, time="0.1 s"}]',
        'study.vary={"kernel.tension"=["20 mN/m"]}',
    )
    share = column(drawn(tmp_path / "study-curves.csv"), "y")
    assert share[0] > 2.5
    assert share[-1] == pytest.approx(1.0, abs=0.1)


@pytest.mark.slow
def test_only_what_drains_relaxes_later_under_a_larger_bead(tmp_path: Path) -> None:
    """Four times the contact radius is 16 times later; of a network that flows it is the same."""
    run("flow_or_drain.toml", tmp_path, "grid.points=24")
    rows = drawn(tmp_path / "study-curves.csv")
    (drains, later), (flows, alike) = (
        [
            column([row for row in rows if row["curve"] == f"kernel = {kernel}, {radius}"], "y")
            for radius in ("indenter.radius = 250 µm", "indenter.radius = 1 mm")
        ]
        for kernel in ("poroelastic", "viscoelastic")
    )
    np.testing.assert_allclose(flows, alike, rtol=1e-6)
    # The times 0.2 and 3 s of the small bead are 3.2 and 48 s of the large one.
    assert later[5] == pytest.approx(drains[3], abs=0.03)
    assert drains[5] < later[5] - 0.1


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:of 2 runs, in . the cells are too coarse")
def test_oscillation_a_skin_lowers_the_phase(tmp_path: Path) -> None:
    """A skin adds more to the storage than to the loss."""
    run(
        "oscillation.toml",
        tmp_path,
        "grid.points=16",
        "loading.depth.2={amplitude=0.2e-6,frequency=0.1,cycles=2,num=8}",
        'study.vary={"kernel.tension"=[0.0,0.5]}',
    )
    path = tmp_path / "study-curves.csv"
    storage, loss = (column(drawn(path, series=name), "y") for name in ("K′", "K″"))
    assert storage[1] > 2 * storage[0]
    assert loss[0] < loss[1] < 1.5 * loss[0]
