"""Sines of a hold: K′ and K″ of made curves, moduli under a tension, and of the kernel."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.special import beta, betainc, gamma

import pellicle as pl
from pellicle.errors import ConfigError
from pellicle_axisymmetric import dynamic_punch_stiffness, punch_radius
from pellicle_fit.contact.curve import Curve
from pellicle_fit.dynamic import complex_moduli, recorded_stiffness
from pellicle_fit.effect import Effect, Solid
from pellicle_fit.explanation import Explanation
from pellicle_fit.files.cleaning import clean
from pellicle_fit.files.measurement import Measurement
from pellicle_fit.report.tables import sines
from pellicle_fit.sine import Sine
from tests.tables_of_runs import half_space, paraboloid, pressing, relaxing

RADIUS, DEPTH, MODULUS = 5e-6, 1e-6, 2e3
RATE, RAMP, HOLD, GAP, CYCLES = 200.0, 1.0, 2.0, 0.3, 10
"""Rows in a second; of made curves the ramp, the hold before sines and between them [s], cycles."""
AMPLITUDE, TOUCH = 2e-8, 3e-6
FREQUENCIES = 1.0, 3.0, 10.0
SHARE, TIME, EXPONENT = 0.5, 0.3, 0.15
"""Of a standard linear solid, and of a power law."""
BEAD: Any = pl.indenter("paraboloid", radius=RADIUS)


def effect(name: str, **fields: Any) -> Any:
    """Return an effect with values of its quantities."""
    return pl.registry().make(Effect, {"type": name, **fields})


ZENER = effect("standard_linear", relaxed_share=SHARE, relaxation_time=TIME)
POWER = effect("power_law", relaxation_exponent=EXPONENT)


def modulus_of(law: Any, frequency: Any) -> Any:
    """Return E*(ω)/E* of a law in closed form."""
    s = 2j * np.pi * np.asarray(frequency)
    if law is ZENER:
        return 1 - SHARE + SHARE * s * TIME / (1 + s * TIME)
    return s**EXPONENT * gamma(1 - EXPONENT) if law is POWER else np.ones_like(s)


def stiffness_of(law: Any, tension: float, share: float) -> Any:
    """Return K′ + iK″ of the sines [N/m], where the modulus has fallen to a share."""
    length = 2 * tension / (share * MODULUS)
    slope = BEAD.force_curve(np.array([DEPTH]), length).by_depth
    radius = punch_radius(slope, length)[0]
    return dynamic_punch_stiffness(radius, MODULUS * modulus_of(law, FREQUENCIES), tension)


@cache
def made(law: Any = None, tension: float = 0.0, spring: float | None = None) -> Any:
    """Return times, positions of the tip, forces and the stiffness of a curve without noise.

    The effective modulus of a power law is exact while the contact grows without a tension; it
    stays in the hold, so that all sines have one.
    """
    starts = RAMP + HOLD + np.cumsum([0.0, *(CYCLES / f + GAP for f in FREQUENCIES)])
    time = np.arange(-0.5, starts[-1], 1 / RATE)
    tip = np.minimum(time / RAMP, 1.0) * DEPTH
    falls = np.ones_like(time)
    if law is ZENER:
        falls = 1 - 0.4 * np.clip((time - 0.5) / RAMP, 0.0, 1.0)
    if law is POWER:
        falls = 1.5 * beta(1.5, 1 - EXPONENT) * np.clip(time, 1e-3, RAMP) ** -EXPONENT
    area = [
        f * BEAD.force_curve(np.array([d]), 2 * tension / (f * MODULUS)).force[0]
        for f, d in zip(falls, np.maximum(tip, 0.0), strict=True)
    ]
    force, told = MODULUS * np.array(area), stiffness_of(law, tension, falls[-1])
    for frequency, start, k in zip(FREQUENCIES, starts, told, strict=False):
        at = (time >= start) & (time < start + CYCLES / frequency)
        turn = np.exp(2j * np.pi * frequency * (time[at] - start))
        tip[at] += AMPLITUDE * turn.imag
        force[at] += AMPLITUDE * (k * turn).imag
    return time, tip + TOUCH, force, told


def measured(
    law: Any = None,
    tension: float = 0.0,
    *,
    noise: float = 0.0,
    seed: int = 0,
    spring: float | None = None,
    late: int = 0,
    lag: float = 0.0,
) -> tuple[Measurement, Any]:
    """Return the cleaned curve, whose force has noise over the largest and is read rows late."""
    time, tip, true, told = made(law, tension)
    base = tip + true / spring if spring else tip
    force = np.append(np.full(late, true[0]), true[: true.size - late])
    force = force + noise * true.max() * np.random.default_rng(seed).standard_normal(time.size)
    position = base - force / spring if spring else base
    curve = Measurement(position, force, stiffness=spring, time=time)
    return clean(curve, "approach+hold", FREQUENCIES, lag), told


def curve_of(measurement: Measurement) -> Curve:
    """Return a cleaned curve as fits see it."""
    return Curve(
        measurement.position,
        measurement.force,
        BEAD,
        time=measurement.time,
        unloading=measurement.unloading,
        stiffness=measurement.stiffness,
        sines=measurement.sines,
    )


@pytest.mark.parametrize("spring", [None, 0.05], ids=["free", "cantilever"])
@pytest.mark.parametrize("tension", [0.0, 5e-3])
@pytest.mark.parametrize("law", [None, ZENER, POWER], ids=["elastic", "zener", "power"])
def test_stiffness_of_sines_without_noise(law: Any, tension: float, spring: float | None) -> None:
    """K′ and K″ are those that were made, and so are frequency and amplitude."""
    found, told = measured(law, tension, spring=spring)
    assert [s.frequency for s in found.sines] == pytest.approx(FREQUENCIES, rel=2e-3)
    assert np.array([s.stiffness for s in found.sines]) == pytest.approx(told, rel=2e-3)
    assert [s.amplitude for s in found.sines] == pytest.approx([AMPLITUDE] * 3, rel=2e-3)


@pytest.mark.parametrize("spring", [None, 0.05], ids=["free", "cantilever"])
def test_intervals_hold_the_stiffness_in_95_of_100(spring: float | None) -> None:
    """Deviations of K′ and K″ are those of many curves."""
    off = []
    for seed in range(60):
        found, told = measured(ZENER, noise=0.01, seed=seed, spring=spring)
        for sine, true in zip(found.sines, told, strict=True):
            far = (sine.stiffness - true) / sine.deviation
            off += [far.real, far.imag]
    # Of 360 that hold in 95 of 100 fewer than 330 do so once in 1,000 times.
    assert np.sum(np.abs(off) < 1.96) >= 330
    assert 0.85 < np.std(off) < 1.15


def test_rows_without_the_sines_are_a_hold() -> None:
    """What is left of the curve has no sine."""
    found, _ = measured(ZENER)
    time, _, force, _ = made(ZENER)
    assert found.time is not None
    is_late = found.time > RAMP + 0.5
    assert np.ptp(found.position[is_late]) < 0.02 * AMPLITUDE
    assert np.ptp(found.force[is_late]) < 0.02 * np.ptp(force[time > RAMP + HOLD])
    # What a sine begins or ends in is left out, and nothing of the approach.
    assert np.sum(found.time <= RAMP + HOLD - 0.06) == np.sum(time <= RAMP + HOLD - 0.06)


def test_hold_of_nearly_all_rows_is_no_approach() -> None:
    """The approach ends where the hold begins, though one row in 12 is of it."""
    time, tip, force, _ = made(None)
    found = clean(Measurement(tip, force, time=time), "approach", FREQUENCIES)
    assert found.time is not None
    assert found.time[-1] == pytest.approx(RAMP, abs=2 / RATE)


def test_sines_of_a_solid_that_creeps_leave_its_course() -> None:
    """Where a base creeps by many amplitudes, what a sine begins or ends in is left out as well."""
    time = np.arange(-0.5, 9.0, 1 / RATE)
    creeps = TOUCH + DEPTH * (np.minimum(time, 1) + 0.4 * np.log1p(np.maximum(time - 1, 0.0)))
    force = 1e-9 * np.clip(time, 0.0, 1.0)
    turn = np.where((time >= 3) & (time < 8), np.exp(4j * np.pi * (time - 3)), 0.0)
    tip, force = creeps + AMPLITUDE * turn.imag, force + AMPLITUDE * (2e-3 * turn).imag
    found = clean(Measurement(tip, force, time=time), "approach+hold", (2.0,))
    assert found.sines[0].stiffness == pytest.approx(2e-3, rel=0.01)
    assert found.time is not None
    off = found.position - np.interp(found.time, time, creeps)
    assert np.max(np.abs(off)) < 0.35 * AMPLITUDE
    assert np.sum(np.abs(off) > 0.05 * AMPLITUDE) < 0.1 * RATE / 2


def test_lag_of_the_force_is_taken_off() -> None:
    """A lag turns the phase by ωt, and given it turns it back."""
    late, lag = 2, 2 / RATE
    turned, told = measured(ZENER, late=late)
    found, _ = measured(ZENER, late=late, lag=lag)
    frequencies = np.array(FREQUENCIES)
    turn = np.exp(-2j * np.pi * frequencies * lag)
    assert np.array([s.stiffness for s in turned.sines]) == pytest.approx(told * turn, rel=3e-3)
    assert np.array([s.stiffness for s in found.sines]) == pytest.approx(told, rel=3e-3)
    assert any("a lag of the force of 10 ms is taken off" in text for text in found.messages)


@pytest.mark.parametrize("begins", [(1.5, 1.5, 1.5), (2.0, 2.6, 2.0), (3.0, 2.0, 2.3)])
@pytest.mark.parametrize("ends", [(8.0, 8.0, 8.0), (7.0, 7.4, 6.8)])
def test_sines_at_once_are_told_apart(begins: Any, ends: Any) -> None:
    """Frequencies may stand in the same rows, and leave none of them behind."""
    time, frequencies = np.arange(-1.5, 8.0, 1 / 400), (1.5, 4.0, 10.0)
    tip, force = np.minimum(time, 1.0) * DEPTH, np.maximum(np.minimum(time, 1.0), 0.0) * 1e-9
    stiffness = np.array([1e-3 + 2e-4j, 2e-3 + 5e-4j, 3e-3 + 1e-3j])
    for frequency, k, begin, end in zip(frequencies, stiffness, begins, ends, strict=True):
        stands = (time > begin) & (time < end)
        turn = np.where(stands, np.exp(2j * np.pi * frequency * (time - begin)), 0.0)
        tip, force = tip + AMPLITUDE * turn.imag, force + AMPLITUDE * (k * turn).imag
    found = clean(Measurement(tip, force, time=time), "approach+hold", frequencies)
    assert np.array([s.stiffness for s in found.sines]) == pytest.approx(stiffness, rel=1e-3)
    assert found.time is not None
    hold = found.position[found.time > 1.0]
    assert np.ptp(hold) < 0.6 * AMPLITUDE
    assert np.sum(np.abs(hold - np.median(hold)) > 0.02 * AMPLITUDE) < 0.03 * hold.size
    assert np.sum(found.time <= 1.0) == np.sum(time <= 1.0)


@pytest.mark.parametrize(
    ("frequencies", "says"),
    [
        ((7.0,), "no sine of 7 Hz"),
        ((9.0,), "no sine of 9 Hz"),
        ((80.0,), "fewer than 5 rows in a cycle; give those up to 40 Hz"),
        ((1e-3,), "too short for it"),
    ],
)
def test_sines_that_are_not_there(frequencies: tuple[float, ...], says: str) -> None:
    """A frequency that is not there, too fast or too slow is an error."""
    time, tip, force, _ = made(ZENER)
    with pytest.raises(ConfigError, match=says):
        clean(Measurement(tip, force, time=time), "approach", frequencies)
    with pytest.raises(ConfigError, match="time of each row"):
        clean(Measurement(tip, force), "approach", frequencies)


def explained(*effects: Any, modulus: float = MODULUS) -> Explanation:
    """Return an explanation with the known modulus and contact point."""
    return Explanation(Solid(reduced_modulus=modulus, contact_point=TOUCH), effects)


@pytest.mark.parametrize("tension", [0.0, 5e-3])
@pytest.mark.parametrize("law", [ZENER, POWER], ids=["zener", "power"])
def test_moduli_are_those_of_the_law(law: Any, tension: float) -> None:
    """E′ and E″ are those of the law, and need no law."""
    found, told = measured(law, tension)
    beside = [effect("tension", tension=tension)] if tension else []
    explanation, curve = explained(law, *beside), curve_of(found)
    assert recorded_stiffness(explanation, curve) == pytest.approx(told, rel=3e-3)
    expected = MODULUS * modulus_of(law, FREQUENCIES)
    assert complex_moduli(explanation, curve) == pytest.approx(expected, rel=5e-3)
    # Of the law nothing enters.
    assert complex_moduli(explained(*beside), curve) == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize("name", ["drag", "compliance", "sensitivity", "layer", "offset"])
def test_what_acts_beside_is_taken_off_again(name: str) -> None:
    """The moduli of the stiffness that an explanation records are its own."""
    found, _ = measured(ZENER, spring=0.05)
    of = {
        "drag": {"drag": 5.0},
        "compliance": {"compliance": 20.0},
        "sensitivity": {"sensitivity_error": 0.1},
        "layer": {"thickness": 5e-6, "poissons_ratio": 0.5},
        "offset": {"offset": 1e-10},
    }
    explanation, curve = explained(ZENER, effect(name, **of[name])), curve_of(found)
    told = recorded_stiffness(explanation, curve)
    sines = tuple(s._replace(stiffness=k) for s, k in zip(curve.sines, told, strict=True))
    back = complex_moduli(explanation, replace(curve, sines=sines))
    assert back == pytest.approx(MODULUS * modulus_of(ZENER, FREQUENCIES), rel=1e-5)
    alone = recorded_stiffness(explained(ZENER), curve)
    assert np.max(np.abs(told / alone - 1)) > (5e-4 if name == "offset" else 0.03)


def test_drag_is_ahead_by_a_quarter_of_a_cycle() -> None:
    """A drag adds iωηa."""
    curve = curve_of(measured()[0])
    drag = recorded_stiffness(explained(effect("drag", drag=5.0)), curve)
    radius = np.sqrt(RADIUS * DEPTH)
    ahead = (drag - recorded_stiffness(explained(), curve)) / (2 * np.pi * np.array(FREQUENCIES))
    assert ahead == pytest.approx(5.0 * radius * 1j * np.ones(3), rel=0.05)


def test_trials_are_columns() -> None:
    """Many trials at once are those one by one."""
    found, _ = measured(ZENER, 5e-3, spring=0.05)
    curve, column = curve_of(found), np.array([[1.0], [1.3], [0.7]])
    parts = (
        ("standard_linear", "tension", "size"),
        (
            {"relaxed_share": SHARE * column, "relaxation_time": TIME / column},
            {"tension": 5e-3 * column},
            {"size_error": 0.1 * column},
        ),
    )
    fields = dict(zip(*parts, strict=True))
    blank = [effect(name) for name in fields]
    together = explained(*(e.of_values(fields[e.type_name]) for e in blank))
    each = [
        explained(
            *(
                e.of_values({n: float(v[k, 0]) for n, v in fields[e.type_name].items()})
                for e in blank
            )
        )
        for k in range(3)
    ]
    one_by_one = np.array([recorded_stiffness(explanation, curve) for explanation in each])
    assert recorded_stiffness(together, curve) == pytest.approx(one_by_one, rel=1e-9)


def test_a_fit_tells_tension_from_relaxation_by_sines() -> None:
    """Sines decide what an approach alone cannot."""
    time, tip, force, _ = made(POWER)
    noise = 0.01 * force.max() * np.random.default_rng(2).standard_normal(time.size)
    options: dict[str, Any] = {"indenter": BEAD, "time": time}
    alone = pl.fit(tip, force + noise, **options)
    with_sines = pl.fit(tip, force + noise, frequencies=[*FREQUENCIES], **options)
    assert alone.verdict.name == "CANNOT_TELL"
    assert with_sines.verdict.name == "OTHER"
    exponent = with_sines.estimates()["relaxation_exponent"]
    assert exponent.low is not None
    assert exponent.high is not None
    assert exponent.low < EXPONENT < exponent.high < 1.2 * EXPONENT
    for sine, told in zip(with_sines.sines, modulus_of(POWER, FREQUENCIES), strict=True):
        for name, part in (("storage", told.real), ("loss", told.imag)):
            found = sine[f"{name}_modulus"]
            assert found.low is not None
            assert found.high is not None
            assert found.low < MODULUS * part < found.high
    assert with_sines.values()["sine_1_loss_modulus"] == with_sines.sines[0]["loss_modulus"].value


def test_table_is_in_the_units_of_its_heads() -> None:
    """Stiffness in mN/m, moduli in kPa, and the phase of the loss over the storage in degrees."""
    time, tip, force, _ = made(POWER)
    options: dict[str, Any] = {"indenter": BEAD, "time": time, "model": [], "rivals": []}
    fit = pl.fit(tip, force, frequencies=[*FREQUENCIES], **options)
    columns = {column.words: column.values for column in sines(fit).columns}
    for head, name in {"K′ [mN/m]": "storage_stiffness", "E″ [kPa]": "loss_modulus"}.items():
        unit = {"K": 1e3, "E": 1e-3}[head[0]]
        told = [float(str(text).partition(" ")[0]) for text in columns[head]]
        assert told == pytest.approx([unit * sine[name].value for sine in fit.sines], rel=0.01)
    phases = np.angle(stiffness_of(POWER, 0.0, 1.0), deg=True)
    assert [float(str(text)) for text in columns["phase [°]"]] == pytest.approx(phases, rel=0.02)


def held(law: Any) -> tuple[Any, Any, Any]:
    """Return times, positions and forces of a ramp, a hold that relaxes and sines in it."""
    time = np.arange(-0.5, 18.0, 1 / RATE)
    tip = DEPTH * np.minimum(time, RAMP) + TOUCH
    force = explained(law).force(Curve(tip, tip, BEAD, time, np.zeros(time.size, bool)))
    moduli = MODULUS * modulus_of(law, FREQUENCIES)
    for frequency, start, modulus in zip(FREQUENCIES, (3.0, 13.5, 17.0), moduli, strict=True):
        at = (time >= start) & (time < start + CYCLES / frequency)
        turn = AMPLITUDE * np.exp(2j * np.pi * frequency * (time[at] - start))
        tip[at] += turn.imag
        force[at] += 2 * np.sqrt(RADIUS * DEPTH) * (modulus * turn).imag
    return time, tip, force


def test_a_pool_of_one_curve_twice_agrees() -> None:
    """Curves with sines agree on what they share, if they do."""
    time, tip, force = held(ZENER)
    noise = 0.003 * force.max() * np.random.default_rng(2).standard_normal(time.size)
    twice = dict.fromkeys("ab", (tip, force + noise, time))
    options: dict[str, Any] = {"segment": "approach+hold", "rivals": ["standard_linear"]}
    found = pl.fit_pooled(twice, indenter=BEAD, frequencies=[*FREQUENCIES], **options)
    assert found.answer.selected.types == {"standard_linear"}
    assert found.answer.agreement.chi_squared < 1
    assert len(found.sines) == 2 * len(FREQUENCIES)


@pytest.mark.parametrize("exponent", [0.15, 0.3])
def test_force_of_a_hold_in_closed_form(exponent: float) -> None:
    """From the ramp on, at its turn too, a power law gives an incomplete beta function."""
    time = np.linspace(-0.5, 9.5, 1001)
    depth = DEPTH * np.minimum(time, 1) + TOUCH
    curve = Curve(depth, depth, BEAD, time, np.zeros(time.size, bool))
    law = effect("power_law", relaxation_exponent=exponent)
    touches = time > 0.1
    since = np.maximum(time[touches], 1.0)
    before = betainc(1.5, 1 - exponent, np.minimum(1.0, 1 / since))
    exact = 1.5 * beta(1.5, 1 - exponent) * time[touches] ** (1.5 - exponent) * before
    exact *= 4 / 3 * MODULUS * np.sqrt(RADIUS) * DEPTH**1.5
    force = explained(law).force(curve)[touches]
    np.testing.assert_allclose(force, exact, atol=1e-3 * exact.max())


def test_a_touch_by_rounding_is_none() -> None:
    """A search that tries the deepest row as contact point gets a finite force, and no warning."""
    time = np.linspace(-0.5, 1.0, 100)
    depth = DEPTH * time + TOUCH
    curve = Curve(depth, depth, BEAD, time, np.zeros(time.size, bool))
    deepest = float(np.nextafter(depth[-1], 0.0))
    solid = Solid(reduced_modulus=MODULUS, contact_point=deepest)
    assert np.all(np.abs(Explanation(solid, (ZENER,)).force(curve)) < 1e-20)


def test_means_of_a_hold_are_least_where_its_rows_are() -> None:
    """A solid that relaxes within the first hundredth of a hold is followed by its means."""
    time = np.linspace(-0.5, 29, 5900)
    depth = DEPTH * np.minimum(time, 1) + TOUCH
    curve = Curve(depth, depth, BEAD, time, np.zeros(time.size, bool))
    force = explained(ZENER).force(curve)
    noise = 0.003 * force.max() * np.random.default_rng(3).standard_normal(time.size)
    options: dict[str, Any] = {"segment": "approach+hold", "rivals": ["standard_linear"]}
    found = pl.fit(depth, force + noise, time=time, indenter=BEAD, **options).answer.selected
    assert found.types == {"standard_linear"}
    of_rows = found.of_rows
    assert found.chi_squared - of_rows.minimise(found.minimum.at).chi_squared < 0.1


@pytest.mark.parametrize("seed", [0, 1])
def test_a_pair_explains_a_hold_no_worse_than_its_part(seed: int) -> None:
    """Beside what simple explanations leave of a hold, no search ends at the least χ²."""
    time, tip, force = held(POWER)
    noise = 0.01 * force.max() * np.random.default_rng(seed).standard_normal(time.size)
    options: dict[str, Any] = {"segment": "approach+hold", "rivals": ["power_law"]}
    options |= {"indenter": BEAD, "frequencies": [*FREQUENCIES]}
    found = pl.fit(tip, force + noise, time=time, **options)
    fits = {fit.types: fit for fit in found.answer.explanations}
    alone, pair = fits[frozenset({"power_law"})], fits[frozenset({"power_law", "tension"})]
    # What leads nowhere is given up within 4 in AIC.
    assert pair.chi_squared <= alone.chi_squared + 4
    assert pair.polish().chi_squared <= alone.chi_squared + 0.1
    assert not found.tension_needed


def test_sines_beside_what_is_not_known_are_excused() -> None:
    """Adhesion, and a tension on a layer, have no stiffness of sines."""
    sine = Sine(1.0, AMPLITUDE, 1e-3 + 1e-4j, 1e-5, TOUCH + DEPTH, 1e-9, 2.0, 1, 100)
    depth = np.linspace(-0.3e-6, DEPTH, 200)
    rows = depth + TOUCH, MODULUS * BEAD.force_curve(depth, 0.0).force
    curve = Curve(*rows, BEAD, time=np.linspace(0, 1, 200), sines=(sine,))
    adhesive = explained(effect("adhesion", work_of_adhesion=1e-5))
    assert "sine" in adhesive.excuse([curve])
    assert not adhesive.excuse([replace(curve, sines=())])
    layer = effect("layer", thickness=5e-6, poissons_ratio=0.5)
    assert "sine" in explained(layer, effect("tension", tension=1e-3)).excuse([curve])
    assert not explained(effect("tension", tension=1e-3)).excuse([curve])


@pytest.mark.slow
@pytest.mark.parametrize("tension", [0.0, 1e-3], ids=["free", "tensed"])
def test_sines_of_the_kernel(tension: float) -> None:
    """A run that oscillates tells K′ and K″ of the correspondence at a fixed contact."""
    depth, frequency, time = 5e-7, 2.0, 0.05
    kernel: dict[str, Any] = relaxing(half_space(MODULUS), SHARE, time)
    if tension:
        kernel = {"type": "coated", "tension": tension, "substrate": kernel}
    legs = [
        {"to": depth, "time": 1.0, "num": 8},
        {"hold": 1.0, "num": 3},
        {"amplitude": depth / 100, "frequency": frequency, "cycles": 2, "num": 32},
    ]
    config = pressing(
        128, 4.5e-6 if not tension else 6e-6, kernel, paraboloid(RADIUS), depth=legs
    ) | {"solver": {"type": "active_set", "tolerance": 1e-8}}
    run = pl.run(config, progress=False)
    (response,) = run.oscillations
    solved = response.storage_stiffness + 1j * response.loss_stiffness
    sine = Sine(frequency, 1e-8, solved, 1e-6, depth, float(run.dataset["force"][-1]), 3.0, 1, 9)
    path = np.linspace(-0.1 * depth, depth, 50)
    curve = Curve(path, path, BEAD, time=np.linspace(0, 1, 50), sines=(sine,))
    law = effect("standard_linear", relaxed_share=SHARE, relaxation_time=time)
    effects = [law, *([effect("tension", tension=tension)] if tension else [])]
    known = Explanation(Solid(reduced_modulus=MODULUS, contact_point=0.0), tuple(effects))
    (told,) = recorded_stiffness(known, curve)
    assert solved.real == pytest.approx(told.real, rel=0.015)
    assert solved.imag == pytest.approx(told.imag, rel=0.03)
