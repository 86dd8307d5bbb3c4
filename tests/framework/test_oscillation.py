"""The response of an oscillation: closed forms of signals, and of contacts in time."""

from dataclasses import asdict
from math import isnan, nan, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.analysis import Oscillation, oscillations
from pellicle.variables import names_of
from tests.command import call
from tests.tables_of_runs import coated, half_space, heights, pressing, relaxing

K = 3.0 + 0.4j
AMPLITUDE, FREQUENCY = 2e-6, 5.0


def signal(cycles: float = 2, num: int = 16, drift: float = 0.0) -> dict[str, Any]:
    """Return a leg of rest and one of an oscillation with the complex stiffness `K`."""
    count = np.arange(1, round(cycles * num) + 1) / num
    angle = 2 * pi * np.append([0.0, 0.0], count)
    depth = 1e-5 + AMPLITUDE * np.sin(angle)
    force = 1e-4 + abs(K) * AMPLITUDE * np.sin(angle + np.angle(K)) + drift * angle / (2 * pi)
    return {
        "time": np.append([0.0, 1.0], 1 + count / FREQUENCY),
        "cycle": np.append([nan, nan], count),
        "depth": depth,
        "force": force,
    }


@pytest.mark.parametrize(
    ("cycles", "num", "drift"),
    [(1, 4, 0.0), (2, 16, 0.0), (2, 16, 3e-6), (2, 15, 3e-6), (3.5, 16, -3e-6)],
)
def test_sines_have_their_complex_stiffness(cycles: float, num: int, drift: float) -> None:
    """K′, K″ and ∮F dδ = πK″δ̂² are exact to rounding, even and odd samples, a drift apart."""
    (response,) = oscillations(**signal(cycles, num, drift))
    assert response.oscillation_frequency == pytest.approx(FREQUENCY, rel=1e-12)
    assert response.oscillation_amplitude == pytest.approx(AMPLITUDE, rel=1e-10)
    assert response.storage_stiffness == pytest.approx(K.real, rel=1e-9)
    assert response.loss_stiffness == pytest.approx(K.imag, rel=1e-9)
    assert response.phase == pytest.approx(float(np.angle(K)), rel=1e-9)
    assert response.cycle_dissipation == pytest.approx(pi * K.imag * AMPLITUDE**2, rel=1e-9)
    if cycles > 1:
        assert response.cycle_drift == pytest.approx(abs(drift) / (abs(K) * AMPLITUDE), abs=1e-9)


def test_overtones_count_in_the_loop_and_not_in_the_stiffness() -> None:
    """∮F dδ of signals with overtones is the area of their loop; that of the polygon is less.

    The area is that of a polygon of 1e5 corners.
    """

    def loop(count: Any) -> tuple[Any, Any]:
        angle = 2 * pi * count
        depth = np.sin(angle) + 0.2 * np.cos(2 * angle)
        return depth, np.sin(angle + 0.3) + 0.1 * np.sin(2 * angle) + 0.05 * np.cos(3 * angle)

    count = np.arange(17) / 16
    depth, force = loop(count)
    (response,) = oscillations(count, np.append(nan, count[1:]), depth, force)
    fine, push = loop(np.linspace(0, 1, 100_001))
    assert response.cycle_dissipation == pytest.approx(float(np.trapezoid(push, fine)), rel=1e-8)
    assert response.storage_stiffness == pytest.approx(np.cos(0.3))
    assert float(np.trapezoid(force, depth)) < 0.99 * response.cycle_dissipation


def test_each_leg_has_its_response() -> None:
    """Legs in a row are told apart; one without a whole cycle, or a failed step, is NaN."""
    one, other = signal(), signal(1.5)
    for name in ("time", "cycle", "depth", "force"):
        other[name] = other[name][2:]
    other["time"] = other["time"] - 1 + one["time"][-1]
    other["force"] = 2 * other["force"] - 1e-4
    path = {name: np.append(one[name], other[name]) for name in one}
    first, second = oscillations(**path)
    assert (first.loss_stiffness, second.loss_stiffness) == pytest.approx((K.imag, 2 * K.imag))
    converged = np.ones(path["time"].size, bool)
    converged[30] = False
    spoilt, fine = oscillations(**path, converged=converged)
    assert isnan(spoilt.loss_stiffness)
    np.testing.assert_equal(asdict(fine), asdict(second))
    short = {name: values[:-12] for name, values in path.items()}
    assert [isnan(o.loss_stiffness) for o in oscillations(**short)] == [False, True]
    assert oscillations(**{name: values[:2] for name, values in path.items()}) == []
    assert oscillations([], [], [], []) == []


def test_nothing_oscillates_out_of_contact() -> None:
    """Where no force answers there is no phase."""
    path = signal() | {"force": np.zeros(34)}
    (response,) = oscillations(**path)
    assert isnan(response.phase)
    assert response.oscillation_amplitude == pytest.approx(AMPLITUDE)


def test_variables_are_registered() -> None:
    """Every number of an oscillation is a variable of results, in this order."""
    assert tuple(Oscillation.__annotations__) == names_of("oscillation")


MODULUS, TIME, SHARE = 1e4, 0.05, 0.6
LEGS: list[dict[str, Any]] = [
    {"to": "1 um", "time": 0, "num": 1},
    {"hold": "1 s", "num": 1},
    {"amplitude": "50 nm", "frequency": "2 Hz", "cycles": 3, "num": 32},
]


def expected(frequency: float) -> complex:
    """Return E*(ω)/E(0) of the solid."""
    x = 2j * pi * frequency * TIME
    return 1 - SHARE + SHARE * x / (1 + x)


def run(**changes: Any) -> dict[str, Any]:
    """Return the run of a flat punch that oscillates, with changes."""
    solid = relaxing(half_space(MODULUS), SHARE, TIME)
    tables = pressing(8, "0.5 mm", solid, {"type": "flat_punch", "radius": "0.2 mm"}, depth=LEGS)
    solver = {"type": "active_set", "tolerance": 1e-10}
    return {**tables, "solver": solver, "outputs": [], **changes}


def check(response: Oscillation, stiffness: complex, frequency: float) -> None:
    """Compare a response with the correspondence principle, 0.5 %, and its loop, 1e-3."""
    measured = complex(response.storage_stiffness, response.loss_stiffness)
    assert measured.real == pytest.approx(stiffness.real, rel=5e-3)
    assert measured.imag == pytest.approx(stiffness.imag, rel=5e-3)
    assert response.phase == pytest.approx(float(np.angle(stiffness)), rel=5e-3)
    assert response.oscillation_frequency == pytest.approx(frequency)
    assert abs(response.cycle_drift) < 1e-3
    area = pi * response.loss_stiffness * response.oscillation_amplitude**2
    assert response.cycle_dissipation == pytest.approx(area, rel=1e-3)


@pytest.mark.parametrize(
    "loading",
    [
        {"depth": LEGS},
        {"force": [{**LEGS[0], "to": "2 uN"}, LEGS[1], {**LEGS[2], "amplitude": "0.1 uN"}]},
        {"base_displacement": LEGS, "spring_constant": "2 N/m"},
    ],
    ids=["depth", "force", "base_displacement"],
)
def test_flat_punch_obeys_correspondence(loading: dict[str, Any]) -> None:
    """K* = E*(ω) over E(0) times the stiffness of the first jump, whatever is prescribed."""
    result = pl.run(run(loading=loading), progress=False)
    assert result.converged
    first = result.dataset.isel(step=0)
    stiffness = float(first["force"] / first["depth"]) * expected(2.0)
    (response,) = result.oscillations
    check(response, stiffness, 2.0)
    assert result.path_summary["loss_stiffness"] == response.loss_stiffness


@pytest.mark.parametrize("tension", [0.0, 0.5])
def test_full_contact_obeys_correspondence(tension: float) -> None:
    """A sine in full contact on springs of a layer oscillates with E*(ω)/G(0) of its area.

    The mean of a periodic contact is displaced by G(0) of a compressible layer only. The tension
    does not act on it.
    """
    grid = pl.Grid(points=[16, 6], size="1 mm", boundary="periodic")
    x, y = grid.coordinates()
    wave = 1e-6 * (np.cos(2 * pi * x / 1e-3) - 1) + 0 * y
    layer = pl.kernel(
        "bonded_layer", reduced_modulus=MODULUS, poissons_ratio=0.3, thickness="0.3 mm"
    )
    frequency = 3.0
    about = {**LEGS[2], "frequency": frequency, "amplitude": "0.1 um", "cycles": 2}
    full = run(
        grid=grid,
        kernel=coated(run()["kernel"] | {"solid": layer}, tension),
        indenter=heights(wave),
        loading={"depth": [{**LEGS[0], "to": "20 um"}, LEGS[1], about]},
    )
    result = pl.run(full, progress=False)
    assert result.converged
    assert bool(result.dataset["contact"].all())
    stiffness = grid.area / layer.mean_compliance() * expected(frequency)
    check(result.oscillations[0], stiffness, frequency)


def test_error_falls_as_the_square_of_the_step() -> None:
    """K″ falls short of the principle by (π/n)²/3, for steps shorter than the relaxation."""
    errors = []
    for num in (8, 16):
        result = pl.run(
            run(loading={"depth": [*LEGS[:2], {**LEGS[2], "num": num, "cycles": 2}]}),
            progress=False,
        )
        first = result.dataset.isel(step=0)
        exact = float(first["force"] / first["depth"]) * expected(2.0)
        errors.append(1 - result.oscillations[0].loss_stiffness / exact.imag)
    np.testing.assert_allclose(errors, (pi / np.array([8, 16])) ** 2 / 3, rtol=0.1)


@pytest.mark.slow
def test_sweep_in_one_run_and_in_a_study(tmp_path: Path) -> None:
    """Two legs of a run have the responses of two runs of a study, which tabulates them."""
    sweep = [{**LEGS[2], "frequency": f, "cycles": 2, "num": 8} for f in (0.5, 2.0)]
    rest = [*LEGS[:2], *sweep[:1], {"hold": "1 s", "num": 1}, *sweep[1:]]
    result = pl.run(run(loading={"depth": rest}), progress=False)
    study = pl.Study(
        run=run(loading={"depth": [*LEGS[:2], sweep[0]]}),
        vary={"loading.depth.2.frequency": [0.5, 2.0]},
        derived={"loss_factor": "loss_stiffness / storage_stiffness"},
    )
    table = pl.run_study(study, directory=tmp_path, progress=False)
    for name in ("storage_stiffness", "loss_stiffness", "phase", "cycle_dissipation"):
        of_legs = [getattr(response, name) for response in result.oscillations]
        np.testing.assert_allclose(table[name], of_legs, rtol=1e-6)
    np.testing.assert_allclose(table["loss_factor"], np.tan(table["phase"]), rtol=1e-9)
    assert table["loss_stiffness"].attrs["units"] == "N/m"
    shown = call("show", tmp_path).output
    assert "dissipation of a cycle [fJ]" in shown
    result.save(tmp_path / "sweep.h5")
    lines = call("show", tmp_path / "sweep.h5").output.splitlines()
    begin = lines.index("oscillations:")
    assert lines[begin + 1].startswith("oscillation frequency [Hz]  oscillation amplitude [nm]")
    assert [line.split()[0] for line in lines[begin + 2 : begin + 4]] == ["0.5", "2"]


def test_derived_columns_need_an_oscillation() -> None:
    """The loss of a path that does not oscillate is refused before anything is solved."""
    with pytest.raises(pl.ConfigError, match="loss_stiffness"):
        pl.Study(
            run=run(loading={"depth": LEGS[:2]}),
            vary={"grid.points": [8, 10]},
            derived={"loss": "loss_stiffness"},
        )
