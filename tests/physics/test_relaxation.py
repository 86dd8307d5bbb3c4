"""Contacts of solids that relax, in time, against closed forms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from relaxation import triangle

import pellicle as pl
from pellicle.runs import steps

MODULUS, RADIUS = 1e4, 1e-3
SLS = [{"fraction": 0.8, "time": "2 s"}]
PUNCH = {"type": "flat_punch", "radius": "0.2 mm"}
PARABOLOID = {"type": "paraboloid", "radius": RADIUS}


def solid(relaxation: Sequence[dict[str, Any]] | None = None, **fields: Any) -> dict[str, Any]:
    """Return a half-space that relaxes."""
    elastic = {"type": "half_space", "reduced_modulus": MODULUS}
    law = fields or {"relaxation": list(SLS if relaxation is None else relaxation)}
    return {"type": "viscoelastic", "solid": elastic, **law}


def configuration(**changes: Any) -> dict[str, Any]:
    """Return the run of a flat punch, with changes."""
    return {
        "grid": {"points": 24, "size": "1 mm", "boundary": "free"},
        "kernel": solid(),
        "indenter": PUNCH,
        "solver": {"type": "active_set", "tolerance": 1e-10},
        **changes,
    }


def solved(**changes: Any) -> Any:
    """Return the dataset of a run, every step of which converged."""
    result = pl.run(configuration(**changes), progress=False)
    assert not result.failures()
    return result.dataset


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize("number", [2, 9])
def test_force_at_a_depth_relaxes_as_the_modulus(boundary: str, number: int, solver: str) -> None:
    """Under a flat punch F = F(0) E(t)/E(0), exactly at steps of any size."""
    times = [0.0, *np.geomspace(0.01, 20.0, number)]
    data = solved(
        grid={"points": 24, "size": "1 mm", "boundary": boundary},
        loading={"depth": [1e-5] * len(times), "time": times},
        solver={"type": solver, "tolerance": 1e-10},
    )
    ratio = data["force"].values / data["force"].values[0]
    np.testing.assert_allclose(ratio, 0.2 + 0.8 * np.exp(-np.array(times) / 2), rtol=1e-8)
    np.testing.assert_array_equal(data["time"], times)
    assert data["time"].attrs["units"] == "s"


def creep(number: int, solver: str) -> float:
    """Return the depth after 5 s over that at once, of a flat punch under a force."""
    times = np.linspace(0.0, 5.0, number + 1)
    data = solved(
        loading={"force": [1e-6] * len(times), "time": list(times)},
        solver={"type": solver, "tolerance": 1e-11},
    )
    depth = data["depth"].values
    return float(depth[-1] / depth[0])


def test_creep_under_a_force_converges_at_second_order(solver: str) -> None:
    """The depth of a flat punch follows J(t)/J(0) = 5 − 4 e^(−t/10 s)."""
    exact = 5 - 4 * np.exp(-5 / 10)
    errors = [abs(creep(number, solver) / exact - 1) for number in (4, 8, 16)]
    assert errors[0] < 0.02
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2.0, atol=0.15)


def test_full_contact_of_a_sine_relaxes(solver: str) -> None:
    """A wave pressed flat carries (E* q/2) E(t) Δ, to 1e-9; its surface does not move."""
    grid = pl.Grid(points=[24, 6], size="1 mm", boundary="periodic")
    x, y = grid.coordinates()
    q, amplitude = 2 * np.pi / 1e-3, 1e-6
    wave = np.cos(q * x) + 0 * y
    times = [0.0, 0.1, 0.1, 1.0, 30.0]
    data = solved(
        grid=grid,
        indenter={"type": "heights", "values": amplitude * wave, "unit": 1.0},
        loading={"mean_pressure": [MODULUS * q * amplitude] * 5, "time": times},
        solver={"type": solver, "tolerance": 1e-11},
    )
    amplitudes = 2 * (data["pressure"].values * wave).mean(axis=(1, 2))
    expected = MODULUS * q / 2 * amplitude * (0.2 + 0.8 * np.exp(-np.array(times) / 2))
    np.testing.assert_allclose(amplitudes, expected, rtol=1e-9)


@pytest.mark.parametrize("boundary", ["half_space", "bonded_layer"])
def test_full_contact_of_a_sine_under_a_tensed_skin(boundary: str, solver: str) -> None:
    """The wave carries (1/G₀) E(t) Δ + τ₀ q² Δ: the tension does not relax, to 1e-9."""
    grid = pl.Grid(points=[24, 6], size="1 mm", boundary="periodic")
    x, y = grid.coordinates()
    q, amplitude, tension = 2 * np.pi / 1e-3, 1e-6, 2.0
    wave = np.cos(q * x) + 0 * y
    times = [0.0, 0.1, 0.1, 1.0, 30.0]
    fields: dict[str, Any] = {"reduced_modulus": MODULUS}
    if boundary == "bonded_layer":
        fields |= {"poissons_ratio": 0.3, "thickness": 3e-4}
    elastic = pl.kernel(boundary, **fields)
    stiffness = 1 / elastic.compliance(np.array([q])).item()
    relaxing = {"type": "viscoelastic", "solid": elastic, "relaxation": SLS}
    data = solved(
        grid=grid,
        kernel={"type": "coated", "tension": tension, "substrate": relaxing},
        indenter={"type": "heights", "values": amplitude * wave, "unit": 1.0},
        loading={
            "mean_pressure": [2 * (stiffness + tension * q**2) * amplitude] * 5,
            "time": times,
        },
        solver={"type": solver, "tolerance": 1e-11},
    )
    amplitudes = 2 * (data["pressure"].values * wave).mean(axis=(1, 2))
    modulus = 0.2 + 0.8 * np.exp(-np.array(times) / 2)
    expected = (stiffness * modulus + tension * q**2) * amplitude
    np.testing.assert_allclose(amplitudes, expected, rtol=1e-9)


@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
@pytest.mark.parametrize("exponent", [0.1, 0.2, 0.3])
def test_power_law_pressed_in_and_drawn_back(exponent: float) -> None:
    """Lee & Radok 1960 and Ting 1966, in steps whose times grow as i² on the way in.

    At a constant speed v, F = 2 √R E t₀^α v^1.5 B(3/2, 1 − α) t^(3/2 − α); contact is lost at
    c/(c − 1) of the time of the approach, c = 2^(1/(1 − α)). The benchmark has N = 128.
    """
    coarse, _, _, _ = triangle(exponent, 24, 10, 2.0)
    largest, own, lost, _ = triangle(exponent, 48, 20, 2.0)
    assert largest < 2e-3
    assert own < 0.01
    assert abs(lost) < 1e-3
    assert np.log2(coarse / largest) > 1.2


@pytest.mark.parametrize(
    ("relaxation", "share"),
    [
        ([{"fraction": 1e-12, "time": 1.0}], 1.0),
        ([{"fraction": 0.8, "time": 1e12}], 1.0),
        ([{"fraction": 0.8, "time": 1e-12}], 0.2),
    ],
)
@pytest.mark.filterwarnings("ignore:loading. the shortest step:UserWarning")
def test_limits_are_elastic(relaxation: list[dict[str, Any]], share: float) -> None:
    """No fraction or endless times give the instantaneous solid, times of nought the relaxed one.

    The first step is a jump, so it is instantaneous in any case.
    """
    depths = [2e-6, 6e-6, 1e-5, 4e-6]
    grid = {"points": 32, "size": "0.4 mm", "boundary": "free"}
    loading = {"depth": depths, "time": [0.0, 1.0, 1.5, 7.0]}
    data = solved(grid=grid, indenter=PARABOLOID, kernel=solid(relaxation), loading=loading)
    elastic = solved(
        grid=grid,
        indenter=PARABOLOID,
        kernel={"type": "half_space", "reduced_modulus": share * MODULUS},
        loading={"depth": depths},
    )
    after = slice(1, None) if share < 1 else slice(None)
    for name in ("force", "contact_area"):
        np.testing.assert_allclose(data[name][after], elastic[name][after], rtol=1e-8)


@pytest.mark.parametrize(("time", "share"), [(1e12, 1.0), (1e-12, 0.2)])
@pytest.mark.filterwarnings("ignore:loading. the shortest step:UserWarning")
def test_limits_under_a_skin_are_elastic(time: float, share: float) -> None:
    """Under a force, in contacts that grow and shrink on a periodic tensed skin, too."""
    forces = [2e-6, 8e-6, 5e-6, 3e-6]
    grid = {"points": 32, "size": "0.4 mm", "boundary": "periodic"}
    relaxing = solid([{"fraction": 0.8, "time": time}])
    data, elastic = (
        solved(
            grid=grid,
            indenter=PARABOLOID,
            kernel={"type": "coated", "tension": 0.05, "substrate": substrate},
            loading={"force": forces, **times},
        )
        for substrate, times in (
            (relaxing, {"time": [0.0, 1.0, 1.5, 7.0]}),
            ({"type": "half_space", "reduced_modulus": share * MODULUS}, {}),
        )
    )
    after = slice(1, None) if share < 1 else slice(None)
    for name in ("depth", "contact_area"):
        np.testing.assert_allclose(data[name][after], elastic[name][after], rtol=1e-8)


@pytest.mark.parametrize("tension", [0.0, 0.05])
def test_every_wave_obeys_the_convolution(tension: float) -> None:
    """While the contact grows and shrinks, p̂ = τ₀ q² û + (E* q/2) ∫ E(t − t′) dû, û linear."""
    times = np.array([0.0, 0.5, 0.5, 2.0, 7.0, 7.3])
    grid = pl.Grid(points=32, size="0.4 mm", boundary="periodic")
    kernel = {"type": "coated", "tension": tension, "substrate": solid()} if tension else solid()
    data = solved(
        grid=grid,
        indenter=PARABOLOID,
        kernel=kernel,
        loading={"force": [2e-6, 5e-6, 8e-6, 8e-6, 3e-6, 6e-6], "time": list(times)},
    )
    q = np.hypot(*grid.wavenumbers())
    u, p = np.fft.rfft2(data["displacement"].values), np.fft.rfft2(data["pressure"].values)
    assert np.ptp(data["contact_area"].values) > 0
    for n, t in enumerate(times):
        relaxed = u[0] * (0.2 + 0.8 * np.exp(-t / 2))
        for k in range(n):
            x = (times[k + 1] - times[k]) / 2
            mean = -np.expm1(-x) / x if x else 1.0
            relaxed += (u[k + 1] - u[k]) * (0.2 + 0.8 * np.exp(-(t - times[k + 1]) / 2) * mean)
        expected = tension * q**2 * u[n] + MODULUS * q / 2 * relaxed
        scale = np.abs(p[n].ravel()[1:]).max()
        np.testing.assert_allclose(
            p[n].ravel()[1:], expected.ravel()[1:], rtol=0, atol=1e-10 * scale
        )


def test_liquid_flows_out_of_the_way() -> None:
    """Fractions that sum to 1 carry nothing in the end, and the solver copes with the decay."""
    times = [0.0, 1.0, 5.0, 20.0]
    with pytest.warns(UserWarning, match="sum to 1, which makes the solid a liquid"):
        data = solved(
            kernel=solid([{"fraction": 0.7, "time": 1.0}, {"fraction": 0.3, "time": 0.5}]),
            loading={"depth": [1e-5] * 4, "time": times},
        )
    t = np.array(times)
    expected = 0.7 * np.exp(-t) + 0.3 * np.exp(-2 * t)
    np.testing.assert_allclose(data["force"] / data["force"][0], expected, rtol=1e-8, atol=1e-11)


def path() -> dict[str, Any]:
    """Return a run of ten steps of unequal duration, in and out, with a jump and a dwell."""
    depth = [2e-6, 5e-6, 9e-6, 1e-5, 1e-5, 1e-5, 7e-6, 6e-6, 3e-6, 4e-6]
    time = [0.0, 0.3, 0.3, 0.5, 2.0, 9.0, 9.1, 9.1, 11.0, 40.0]
    return configuration(
        grid={"points": 32, "size": "0.4 mm", "boundary": "free"},
        indenter=PARABOLOID,
        loading={"depth": depth, "time": time},
    )


def long_path() -> dict[str, Any]:
    """Return a run of forty steps, in and out, with a skin on a free boundary."""
    depths = np.concatenate([np.linspace(6e-6, 1e-5, 16), np.linspace(1e-5, 9e-6, 24)])
    times = np.concatenate([np.linspace(0.0, 3.0, 16), np.linspace(3.5, 15.0, 24)])
    return configuration(
        kernel={"type": "coated", "tension": 0.02, "substrate": solid()},
        grid={"points": 36, "size": "0.9 mm", "boundary": "free"},
        indenter=PARABOLOID,
        loading={"depth": depths.tolist(), "time": times.tolist()},
    )


def periodic_path() -> dict[str, Any]:
    """Return the path of `path` under a force, with a skin on a periodic boundary."""
    run = path()
    return run | {
        "kernel": {"type": "coated", "tension": 0.05, "substrate": solid()},
        "grid": run["grid"] | {"boundary": "periodic"},
        "loading": {
            "force": [2e-6 * (1 + n % 4) for n in range(10)],
            "time": run["loading"]["time"],
        },
    }


@pytest.mark.parametrize("path", [path, periodic_path, long_path])
def test_resumed_run_has_the_same_numbers(
    path: Callable[[], dict[str, Any]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run that is killed on its way goes on bit by bit as one that is not."""
    run = path() | {"outputs": []}
    finished = 3 * len(run["loading"]["time"]) // 5
    whole = pl.run(run | {"outputs": None}, progress=False).dataset
    solve_step, solved_steps = steps.solve_step, 0

    def killed(*arguments: Any) -> Any:
        nonlocal solved_steps
        if solved_steps == finished:
            raise KeyboardInterrupt
        solved_steps += 1
        return solve_step(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(steps, "solve_step", killed)
        with pytest.raises(KeyboardInterrupt):
            pl.run(run, directory=tmp_path, progress=False)
    resumed = pl.run(run, directory=tmp_path, progress=False).dataset
    names = ("pressure", "displacement", "force", "depth", "time", "operator_applications")
    for name in names:
        np.testing.assert_array_equal(resumed[name], whole[name])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"loading": {"depth": [1e-6, 2e-6]}}, "loading.time: is missing"),
        ({"loading": {"depth": [1e-6, 2e-6], "time": [0.0]}}, "1 values for 2 load steps"),
        ({"loading": {"depth": [1e-6, 2e-6], "time": [1.0, 0.5]}}, "falls from 1 to 0.5 s"),
        ({"loading": {"depth": 1e-6, "time": "1 m"}}, "loading.time"),
        (
            {
                "loading": {"depth": [1e-6] * 3, "time": [0.0, 1.0, 1001.0]},
                "kernel": solid(power_law={"exponent": 0.2, "time": 1.0}),
            },
            "lasts 1001 s",
        ),
        (
            {
                "loading": {"depth": [1e-6] * 3, "time": [0.0, 0.0, 1e-4]},
                "kernel": solid(power_law={"exponent": 0.2, "time": 1.0}),
            },
            "has a step of 0.0001 s",
        ),
        ({"loading": {"depth": 1e-6, "time": float("nan")}}, "loading.time"),
        (
            {
                "loading": {"depth": [1e-6] * 2, "time": [0.0, 1001.0]},
                "kernel": {
                    "type": "coated",
                    "tension": 0.05,
                    "substrate": solid(power_law={"exponent": 0.2, "time": 1.0}),
                },
            },
            "lasts 1001 s",
        ),
        (
            {
                "loading": {"depth": 1e-6, "time": 0.0},
                "interaction": {"type": "jkr", "work_of_adhesion": 0.05},
            },
            "interaction.type: 'jkr' takes its range from the cells",
        ),
    ],
)
def test_refuses(changes: dict[str, Any], message: str) -> None:
    """A path that is none, or one that cannot be solved, is refused with the name of the field."""
    with pytest.raises(pl.ConfigError) as caught:
        pl.Run(**configuration(**changes))
    assert message in str(caught.value)


@pytest.mark.parametrize("tension", [0.0, 0.05])
def test_relaxation_far_faster_than_the_steps_is_said(tension: float) -> None:
    """A run would not show how the fast share relaxes; jumps and slow steps alone are no matter."""
    kernel = solid([{"fraction": 0.5, "time": 1e-3}, {"fraction": 0.3, "time": 1.0}])
    if tension:
        kernel = {"type": "coated", "tension": tension, "substrate": kernel}
    grid = {"points": 16, "size": "1 mm", "boundary": "periodic"}
    loading = {"force": [1e-6] * 3, "time": [0.0, 0.0, 0.2]}
    with pytest.warns(UserWarning, match="takes 0.2 s, far longer than .* 0.001 s"):
        solved(grid=grid, kernel=kernel, loading=loading)
    solved(grid=grid, kernel=kernel, loading=loading | {"time": [0.0, 0.0, 0.05]})


def test_elastic_solid_takes_no_notice_of_time() -> None:
    """Times with an elastic kernel are listed, and change nothing."""
    kernel = {"type": "half_space", "reduced_modulus": MODULUS}
    timed = solved(kernel=kernel, loading={"depth": [1e-6, 2e-6], "time": [0, 9]})
    plain = solved(kernel=kernel, loading={"depth": [1e-6, 2e-6]})
    np.testing.assert_array_equal(timed["pressure"], plain["pressure"])
    assert "time" not in plain
