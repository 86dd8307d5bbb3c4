"""Loads: sums that are exact, the surface against integrals, invariances, and what is refused."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk

import pellicle as pl
from pellicle.arrays import Array
from pellicle.components.calls import traction_of
from pellicle_plugins.loads.round import Disc, Droplet, Ring
from pellicle_plugins.loads.shares import within_circle
from pellicle_plugins.validation import discs
from tests.tables_of_runs import coated, half_space, layer, relaxing

RADIUS = 0.25e-3
GRID: dict[str, Any] = {"points": 64, "size": 1e-3}
SKIN = {"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": 0.1}
SOLIDS: dict[str, dict[str, Any]] = {
    "half_space": {"type": "half_space", "reduced_modulus": 1e4},
    "skin": SKIN,
    "layer": coated(layer("bonded_layer", 2e-4, 0.45, youngs_modulus=3e3), 0.1),
}
DROPLET = {
    "type": "droplet",
    "radius": RADIUS,
    "surface_tension": 0.03,
    "contact_angle": "60 degree",
    "width": RADIUS / 4,
}


def solved(load: Any, kernel: Any = SKIN, **parts: Any) -> Any:
    """Return the dataset of a run."""
    run = pl.Run(**{"grid": GRID, "kernel": kernel, "load": load} | parts)
    return pl.run(run, progress=False).dataset


def compliance_of(kernel: dict[str, Any]) -> Any:
    """Return G(q) of a kernel."""
    return pl.registry().make(pl.Kernel, kernel).compliance


@pytest.mark.parametrize("points", [(17, 64), (64, 40)])
@pytest.mark.parametrize("radius", [0.1e-3, 0.333e-3, 0.5e-3])
def test_shares_add_up_to_the_circle(points: tuple[int, int], radius: float) -> None:
    """The share of the cells is πR², 1 wholly inside and 0 wholly outside."""
    grid = pl.Grid(points=points, size=1e-3)
    share = within_circle(*grid.coordinates(), radius)
    assert share.sum() * grid.cell_area == pytest.approx(np.pi * radius**2, rel=1e-12)
    distance = np.hypot(*grid.coordinates())
    reach = 0.5 * np.hypot(*grid.spacing)
    assert (share[distance < radius - reach] == 1).all()
    assert not share[distance > radius + reach].any()


def test_a_ring_and_a_disc_carry_their_force() -> None:
    """A line force sums to 2πRf, also as wide as the circle; a pressure to πR²p."""
    grid = pl.Grid(**GRID)
    for width in (None, 1e-5, 3 * RADIUS):
        ring = traction_of(Ring(radius=0.4 * RADIUS, line_force=-0.03, width=width), grid)
        force = -0.03 * 2 * np.pi * 0.4 * RADIUS
        assert ring.sum() * grid.cell_area == pytest.approx(force, rel=1e-12)
    disc = traction_of(Disc(radius=RADIUS, pressure=100), grid)
    assert disc.sum() * grid.cell_area == pytest.approx(100 * np.pi * RADIUS**2, rel=1e-12)


def test_a_droplet_pulls_and_pushes_alike() -> None:
    """Its force is 0; its volume gives the angle of the cap; it is the sum of ring and disc."""
    angle = np.radians(75.0)
    volume = np.pi * RADIUS**3 * (1 - np.cos(angle)) ** 2 * (2 + np.cos(angle))
    by_volume = Droplet(
        radius=RADIUS, surface_tension=0.03, volume=volume / (3 * np.sin(angle) ** 3)
    )
    assert by_volume.vertical_tension == pytest.approx(0.03 * np.sin(angle), rel=1e-12)
    data = solved(DROPLET)
    assert data["force"].item() == data["mean_pressure"].item() == 0
    pull = 0.03 * np.sin(np.pi / 3)
    parts = [
        {"type": "ring", "radius": RADIUS, "line_force": -pull, "width": RADIUS / 4},
        {"type": "disc", "radius": RADIUS, "pressure": 2 * pull / RADIUS},
    ]
    together = solved({"type": "sum", "parts": parts})
    for name in ("pressure", "displacement"):
        size = float(np.abs(data[name]).max())
        np.testing.assert_allclose(together[name], data[name], atol=1e-12 * size)


def test_the_integrals_are_exact() -> None:
    """An even pressure on a half-space in closed form (Johnson 1985): within, beside, energy."""
    compliance = compliance_of(SOLIDS["half_space"])
    one = [(RADIUS, 100.0)]
    unit = 100 * RADIUS / 1e4
    assert discs.displacement(compliance, one, 0.0) == pytest.approx(2 * unit, rel=1e-10)
    r = 2 * RADIUS
    k = RADIUS / r
    from scipy.special import ellipe

    beside = 4 / np.pi * unit / k * (ellipe(k**2) - (1 - k**2) * ellipk(k**2))
    assert discs.displacement(compliance, one, r) == pytest.approx(beside, rel=1e-10)
    volume = 16 * 100 * RADIUS**3 / (3 * 1e4)
    assert discs.volume_within(compliance, one, RADIUS) == pytest.approx(volume, rel=1e-9)
    assert discs.energy(compliance, one) == pytest.approx(0.5 * 100 * volume, rel=1e-9)


@pytest.mark.parametrize("solid", SOLIDS)
def test_the_surface_is_that_of_the_integral(solid: str) -> None:
    """Off the line the error falls as the square of the cells, to 1e-3 of the surface."""
    exact = discs.droplet(RADIUS, 0.03 * np.sin(np.pi / 3), RADIUS / 4)
    compliance = compliance_of(SOLIDS[solid])
    worst = []
    for points in (64, 128):
        data = solved(DROPLET, SOLIDS[solid], grid=GRID | {"points": points})
        row = data["displacement"].values[0, points // 2 :, points // 2]
        x, y = data["x"].values[points // 2 :], data["y"].values[points // 2]
        r = np.hypot(x, y)
        chosen = np.flatnonzero(np.abs(r - RADIUS) > RADIUS / 4)[:: points // 32]
        true = np.array([discs.displacement(compliance, exact, float(r[n])) for n in chosen])
        worst.append(float(np.abs(row[chosen] - true).max() / np.abs(true).max()))
    assert worst[1] < 1.5e-3
    assert worst[1] < 0.4 * worst[0]


def test_far_away_only_the_force_counts() -> None:
    """On a half-space the surface falls to F/(πE*r) beside a disc."""
    load = {"type": "disc", "radius": 0.2 * RADIUS, "pressure": 100.0}
    data = solved(load, SOLIDS["half_space"])
    edge, row = data["x"].values[-1], data["y"].values[32]
    theory = 100 * 0.04 * RADIUS**2 / (1e4 * np.hypot(edge, row))
    assert data["displacement"].values[0, -1, 32] == pytest.approx(theory, rel=2e-3)


@pytest.mark.parametrize("stripe", [None, 2e-4])
def test_a_straight_ridge_is_a_sum_over_waves(stripe: float | None) -> None:
    """On a periodic skin, to the square of the cells over the width; the datum is the mean."""
    load = {"type": "ridge", "line_force": -0.03, "width": 1e-4, "stripe": stripe}
    grid = {"points": [256, 2], "size": 1e-3, "boundary": "periodic"}
    data = solved({key: value for key, value in load.items() if value is not None}, grid=grid)
    q = 2 * np.pi / 1e-3 * np.arange(1, 20_000)
    spread = -0.03 * np.sinc(0.5 * q * 1e-4 / np.pi)
    if stripe:
        spread = 2 * spread * np.cos(q * stripe / 2) + 0.06 * np.sinc(0.5 * q * stripe / np.pi)
    x = data["x"].values
    waves = 2 / 1e-3 * compliance_of(SKIN)(q) * spread
    true = (waves * np.cos(q * x[:, None])).sum(axis=1)
    np.testing.assert_allclose(
        data["displacement"].values[0, :, 0], true, atol=2e-3 * np.abs(true).max()
    )
    assert abs(data["displacement"].values.mean()) < 1e-12 * np.abs(true).max()
    assert data["ridge_height"].item() == pytest.approx(-true.min(), rel=2e-3)


def test_a_line_on_a_skin_bends_by_its_angle() -> None:
    """Beside a line force f the slope of a tensed surface is f/2τ₀, within a few cells."""
    load = {"type": "ridge", "line_force": -0.2}
    grid = {"points": [4096, 2], "size": 1e-3, "boundary": "periodic"}
    data = solved(load, SKIN | {"tension": 1.0}, grid=grid)
    assert data["surface_slope"].item() == pytest.approx(0.2 / 2, rel=0.01)


def test_width_of_a_ridge_is_that_of_the_section() -> None:
    """Half of the height is reached at the same distance on both sides of a straight ridge."""
    grid = {"points": [256, 2], "size": 1e-3, "boundary": "periodic"}
    data = solved({"type": "ridge", "line_force": -0.03}, grid=grid)
    height = -data["displacement"].values[0, :, 0]
    x = data["x"].values
    middle = np.interp(0.5 * height.max(), height[:128], x[:128])
    assert data["ridge_width"].item() == pytest.approx(-2 * middle, rel=0.02)


@pytest.mark.parametrize("mirror", ["x", "y", "both"])
def test_the_surface_turns_with_the_load(mirror: str, tmp_path: Path) -> None:
    """A map of traction that is mirrored or turned mirrors or turns the surface."""

    def turned(field: Array) -> Array:
        return {"x": field[::-1], "y": field[:, ::-1], "both": field.T}[mirror]

    traction = np.random.default_rng(1).normal(size=(24, 24))
    np.save(tmp_path / "map.npy", turned(traction))
    grid = {"points": 24, "size": 1e-3}
    whole = solved({"type": "map", "values": traction, "unit": "kPa"}, grid=grid)
    other = solved({"type": "map", "path": tmp_path / "map.npy", "unit": "1 kPa"}, grid=grid)
    assert whole["force"].item() == pytest.approx(1e3 * traction.sum() * (1e-3 / 24) ** 2)
    np.testing.assert_allclose(
        other["displacement"][0], turned(whole["displacement"].values[0]), rtol=1e-9, atol=1e-18
    )


def test_one_field_varies_over_the_steps() -> None:
    """A step for each value, which is a column; alone each gives the same surface."""
    radii = [1e-4, 2e-4, 3e-4]
    data = solved(DROPLET | {"radius": {"start": 1e-4, "stop": 3e-4, "num": 3}})
    assert data["load_radius"].values.tolist() == radii
    assert data["operator_applications"].values.tolist() == [1, 1, 1]
    assert {"depth", "gap", "contact", "contact_area", "residual_load"}.isdisjoint(data)
    for step, radius in enumerate(radii):
        alone = solved(DROPLET | {"radius": radius})
        assert np.array_equal(alone["displacement"][0], data["displacement"][step])


def test_a_ridge_grows_in_time() -> None:
    """At a constant load a solid that relaxes sinks from the stiff surface to the soft one."""
    solid, drop = half_space(1e4), DROPLET | {"surface_tension": 0.01}
    times = {"time": [0, 0.1, 0.3, 1, 3, 10, 30, 100]}
    data = solved(drop, relaxing(solid, 0.75, "1 s"), loading=times, grid=GRID)
    at_once = solved(drop, solid)
    in_the_end = solved(drop, solid | {"reduced_modulus": 2.5e3})
    heights = data["ridge_height"].values
    assert heights[0] == pytest.approx(at_once["ridge_height"].item(), rel=1e-12)
    assert heights[-1] == pytest.approx(in_the_end["ridge_height"].item(), rel=1e-2)
    assert (np.diff(heights) > 0).all()
    assert np.isnan(data["elastic_energy"].values[1:]).all()


def test_energy_is_a_variable_of_contacts_too() -> None:
    """Of a paraboloid on a half-space it is the work that pressed it in, 2/5 Fδ (Hertz 1882)."""
    run = {"indenter": {"type": "paraboloid", "radius": "1 mm"}, "loading": {"depth": "50 um"}}
    data = solved(None, SOLIDS["half_space"], **run)
    expected = 0.4 * (data["force"] * data["depth"]).item()
    assert data["elastic_energy"].item() == pytest.approx(expected, rel=2e-3)


def test_what_depends_on_the_cells_is_said() -> None:
    """A line without width or tension, cells that are wide for it, slopes beyond the theory."""
    line = {"type": "ring", "radius": RADIUS, "line_force": -0.003}
    with pytest.warns(pl.ConvergenceWarning, match="no finite height"):
        solved(line, SOLIDS["half_space"])
    solved(line | {"width": 1e-4}, SOLIDS["half_space"])
    with pytest.warns(pl.ConvergenceWarning, match="lacks about 6% of its height"):
        coarse = solved(line)
    fine = solved(line, grid=GRID | {"points": 256})
    assert (coarse["ridge_height"] / fine["ridge_height"]).item() == pytest.approx(0.955, abs=0.01)
    with pytest.warns(pl.ConvergenceWarning, match="slopes of the surface"):
        solved(line | {"line_force": -0.3, "width": 1e-4})


def test_a_load_goes_through_files(tmp_path: Path) -> None:
    """A run with a load is written and read, resumed, studied, and a result opens again."""
    run = pl.Run(grid=GRID, kernel=SKIN, load=DROPLET | {"radius": [1e-4, 2e-4]})
    again = pl.Run.from_json(run.to_json())
    assert again == run
    assert again.identity == run.identity
    outputs: list[dict[str, str]] = [
        *({"type": kind} for kind in ("csv", "figures", "html", "vtk", "maps", "profiles")),
        {"type": "curves", "x": "load_radius", "y": "ridge_height"},
    ]
    shown = pl.Run(**{**json.loads(run.to_json()), "outputs": outputs})
    pl.run(shown, directory=tmp_path, progress=False)
    names = {path.name for path in tmp_path.iterdir()}
    assert {"run.h5", "run.csv", "run-profile.png", "run-load.png", "run.html"} <= names
    assert "Solver:" not in (tmp_path / "run.html").read_text(encoding="utf-8")
    assert pl.load(tmp_path).dataset["ridge_height"].size == 2
    study = pl.Study(
        run=run,
        vary={"kernel.tension": [0.05, 0.1]},
        derived={"share": "ridge_height / load_radius"},
    )
    table = pl.run_study(study, directory=tmp_path / "study", progress=False)
    assert table["share"].shape == (2, 2)
    assert (table["ridge_height"].values[0] > table["ridge_height"].values[1]).all()


@pytest.mark.parametrize(
    "load",
    [
        DROPLET | {"radius": 5e-6, "width": None},
        DROPLET | {"width": 4e-5},
        {"type": "ring", "radius": 2e-5, "line_force": -1e-4},
        {"type": "disc", "radius": 2e-5, "pressure": 10.0},
        {"type": "sum", "parts": [{"type": "disc", "radius": 2e-5, "pressure": 10.0}]},
        {"type": "disc", "radius": [2e-5, 2e-4], "pressure": 10.0},
    ],
)
def test_a_load_of_few_cells_is_told(load: dict[str, Any]) -> None:
    """The surface beside it is not resolved: a drop on one cell leaves none at all."""
    load = {name: value for name, value in load.items() if value is not None}
    with pytest.warns(pl.ConvergenceWarning, match="too coarse|finest part of the load"):
        data = solved(load)
    codes = data["status_code"].values.tolist()
    assert codes == ["COARSE_LOAD", "CONVERGED"][: len(codes)]


def test_a_narrow_period_and_a_single_cell_have_a_width_or_none() -> None:
    """The width of a ridge does not depend on how long a period is along it."""
    load = {"type": "ridge", "line_force": -0.03}
    wide, narrow = (
        solved(load, grid={"points": [256, 2], "size": [1e-3, y], "boundary": "periodic"})
        for y in (1e-3, 1e-5)
    )
    assert wide["ridge_width"].item() == pytest.approx(narrow["ridge_width"].item(), rel=0.05)
    cell = {"points": 1, "size": 1e-3, "boundary": "free"}
    alone = solved({"type": "map", "values": [[-1.0]], "unit": "Pa"}, grid=cell)
    assert alone["ridge_height"].item() > 0
    assert np.isnan(alone["ridge_width"].item())


def test_on_two_bodies_and_on_a_skin_stretched_more_one_way() -> None:
    """Two equal bodies yield twice as much; the energy lies between those of both tensions."""
    ring = {"type": "ring", "radius": RADIUS, "line_force": 1e-3, "width": 7e-5}
    base: dict[str, Any] = {"grid": GRID | {"boundary": "periodic"}, "load": ring}

    def solved(kernel: dict[str, Any]) -> Any:
        return pl.run(pl.Run(**base, kernel=kernel), progress=False).dataset.isel(step=0)

    one, two = solved(SKIN), solved({"type": "pair", "first": SKIN, "second": SKIN})
    np.testing.assert_allclose(two["displacement"], 2 * one["displacement"], rtol=1e-12)
    tense = solved(SKIN | {"tension": 0.4})
    both = solved(SKIN | {"tension": [0.1, 0.4]})
    energies = [part["elastic_energy"].item() for part in (tense, both, one)]
    assert energies == sorted(energies)
