"""What fits answer about curves of known solids: values, intervals, verdicts, flaws."""

from types import SimpleNamespace
from typing import Any, cast

import fit_verdicts
import numpy as np
import pytest
from fit_verdicts import NOISE, TOP, outcome, pink, truth_of
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

import pellicle as pl
from pellicle.arrays import Array
from pellicle_fit.config import DEFAULT_RIVALS
from pellicle_fit.estimation.candidate import Candidate
from pellicle_fit.estimation.intervals import End, Estimate, common_value
from pellicle_fit.estimation.noise import Flaw
from pellicle_fit.selection.forecast import Means, measurements, telling_measurement
from pellicle_fit.selection.forecast import _foretold as foretold
from pellicle_fit.selection.verdict import Verdict, decision
from pellicle_plugins.indenters.of_revolution import Cone, FlatPunch, Paraboloid, Sphere
from tests.physics.frozen.fit_curves import MODULUS, RADIUS, hertz
from tests.plugins.fit.conftest import ends_of, holds

TENSION = 0.3 * RADIUS * MODULUS / 2
"""τ₀ at s = 0.3 R [N/m]."""
BEAD = Paraboloid(radius=RADIUS)
WHITE = np.random.default_rng(4).standard_normal(614)


def curve(
    tension: float = 0.0,
    *,
    points: int = 300,
    deepest: float = TOP,
    noise: float = 0.005,
    seed: int = 1,
    modulus: float = MODULUS,
    before: float = 0.3,
) -> tuple[Array, Array]:
    """Return position and force of an approach that touches at 1 µm."""
    depth = np.linspace(-before, 1.0, points) * deepest
    force = modulus * BEAD.force_curve(depth, 2 * tension / modulus).force
    errors = np.random.default_rng(seed).standard_normal(points)
    return depth + 1e-6, force + noise * force.max() * errors


def fit(position: Array, force: Array, **options: Any) -> pl.Fit:
    """Return the fit by a paraboloid, without rivals unless some are named."""
    return pl.fit(position, force, **{"indenter": BEAD, "rivals": (), **options})


def flaws(found: pl.Fit) -> frozenset[Flaw]:
    """Return what contradicts the best explanation of the first curve."""
    return found.answer.judgements[0].flaws


@pytest.mark.parametrize("body", [BEAD, Sphere(radius=5e-6), Cone(half_angle=1.2)])
def test_exact_curves_give_the_truth(body: Any) -> None:
    """Without noise all quantities come back, for every shape that tells them apart."""
    depth = np.linspace(-0.5e-6, 2e-6, 300)
    force = 8e3 * body.force_curve(depth, 0.7e-6).force
    found = fit(depth + 3e-6, force, indenter=body)
    assert found.reduced_modulus.value == pytest.approx(8e3, rel=1e-4)
    assert found.tension.value == pytest.approx(8e3 * 0.7e-6 / 2, rel=1e-4)
    assert found.contact_point.value == pytest.approx(3e-6, abs=1e-10)


def test_a_force_far_below_0_before_contact() -> None:
    """A detector that is off by half of the force, long before contact too, costs nothing."""
    depth = np.linspace(-10.0, 1.0, 1500) * TOP
    force = MODULUS * BEAD.force_curve(depth, 0.0).force
    force += force.max() * (0.005 * np.random.default_rng(6).standard_normal(1500) - 0.5)
    assert holds(fit(depth, force, baseline="offset").reduced_modulus, MODULUS)


def test_fits_know_no_units() -> None:
    """Lengths and forces in other measure give the same answer in that measure."""
    position, force = curve(TENSION)
    one, length, stress = fit(position, force), 1e4, 30.0
    larger = Paraboloid(radius=RADIUS * length)
    two = fit(position * length, force * stress * length**2, indenter=larger)
    for name, factor in (("reduced_modulus", stress), ("tension", stress * length)):
        for end in ("value", "low", "high"):
            assert getattr(getattr(two, name), end) == pytest.approx(
                getattr(getattr(one, name), end) * factor, rel=2e-3
            )


def test_ends_are_where_the_profile_has_risen() -> None:
    """A minimiser of another kind finds χ² up by the stated threshold at each end."""
    found = fit(*curve(TENSION))
    explained, threshold = found.answer.selected, found.answer.threshold
    objective, best = explained.objective, explained.minimum
    bounds = objective.deviations(best.at)
    for k, slot in enumerate(objective.slots):
        for end in ends_of(explained.estimates[slot.name]):
            others = [i for i in range(best.at.size) if i != k]

            def chi_squared(u: Array, k: int = k, end: float = end, others: Any = others) -> float:
                at = best.at.copy()
                at[k] = objective.slots[k].coordinate(end)
                at[others] += u * bounds[others]
                return objective.chi_squared(at)

            least = minimize(chi_squared, np.zeros(len(others)), method="Nelder-Mead")
            assert least.fun - best.chi_squared == pytest.approx(threshold, rel=0.02)


@pytest.mark.slow
def test_errors_reach_the_bound_and_intervals_hold() -> None:
    """Over random curves errors are those of the Cramér–Rao bound, and 95 % means 95 %."""
    errors, held = [], []
    for seed in range(30):
        found = fit(*curve(TENSION, seed=seed))
        objective, at = found.answer.selected.objective, found.answer.selected.minimum.at
        truth = {"reduced_modulus": MODULUS, "tension": TENSION, "contact_point": 1e-6}
        for name, value in truth.items():
            k = objective.index(name)
            assert k is not None
            error = at[k] - objective.slots[k].coordinate(value)
            errors.append(error / objective.deviations(at)[k])
            held.append(holds(found.answer.selected.estimates[name], value))
    # Three standard deviations of the rms of 30 normal numbers around 1.
    assert 0.6 < np.sqrt(np.mean(np.square(errors))) < 1.4
    assert sum(held) >= 0.88 * len(held)


def test_a_punch_cannot_tell_modulus_and_tension_apart() -> None:
    """A flat punch gives a straight line: one number for two quantities, both ends open."""
    depth, punch = np.linspace(-0.5e-6, 2e-6, 300), FlatPunch(radius=5e-6)
    force = 8e3 * punch.force_curve(depth, 2e-6).force
    force = force + 0.005 * force.max() * np.random.default_rng(3).standard_normal(300)
    found = fit(depth, force, indenter=punch)
    assert found.tension.low is None
    assert found.if_present["reduced_modulus"].low is None
    known = fit(depth, force, indenter=punch, fix={"tension": 8e3 * 2e-6 / 2})
    assert known.reduced_modulus.value == pytest.approx(8e3, rel=0.01)


def test_a_shallow_curve_leaves_the_modulus_open_and_a_deep_one_the_tension() -> None:
    """Where tension carries all, a modulus a hundred times less does as well, and vice versa."""
    shallow = fit(*curve(RADIUS * MODULUS / 2, deepest=1e-3 * RADIUS, noise=0.05))
    assert (shallow.reduced_modulus.low or 0.0) < 0.02 * shallow.reduced_modulus.value
    assert shallow.tension.low is not None
    deep = fit(*curve(0.005 * TENSION))
    assert deep.tension.low is None
    assert deep.tension.high is not None
    # What lacks a tension describes the deep curve as well; alone it would reach its limit.
    assert deep.tension.ends == (End.LACKING, End.CLOSED)
    tension = next(one for one in deep.answer.tied if "tension" in one.types)
    assert tension.estimates["tension"].ends == (End.LIMIT, End.CLOSED)


def test_correlations_are_those_of_the_ellipse() -> None:
    """Along the profile of the tension the modulus moves as much as they say (Wilks 1938)."""
    found = fit(*curve(TENSION)).answer.selected
    objective, minimum = found.objective, found.minimum
    correlation = found.correlations["tension", "reduced_modulus"]
    deviations, at = objective.deviations(minimum.at), minimum.at.copy()
    modulus, tension = objective.index("reduced_modulus"), objective.index("tension")
    assert modulus is not None
    assert tension is not None
    step = 0.1 * deviations[tension]
    at[tension] += step
    moved = objective.minimise(at, [tension]).at[modulus] - minimum.at[modulus]
    slope = moved / step * deviations[tension] / deviations[modulus]
    assert slope == pytest.approx(correlation, rel=0.02)
    assert correlation < -0.9


@pytest.mark.parametrize(("kind", "points", "size"), [("sphere", 96, 14), ("paraboloid", 64, 13)])
def test_a_curve_of_the_solver_is_recovered(kind: str, points: int, size: int) -> None:
    """What was pressed in on a grid, not by the master curve, is found within the intervals."""
    depth = np.linspace(0.1e-6, 1.5e-6, 15)
    run = pl.Run(
        grid={"points": points, "size": f"{size} um", "boundary": "free"},
        kernel={"type": "tensed_membrane", "reduced_modulus": 4e3, "tension": 4e-3},
        indenter={"type": kind, "radius": "5 um"},
        loading={"depth": depth.tolist()},
    )
    forces = pl.run(run, progress=False).dataset["force"].values
    position = np.concatenate([np.linspace(-0.5e-6, -0.01e-6, 60), np.repeat(depth, 20)])
    force = np.concatenate([np.zeros(60), np.repeat(forces, 20)])
    force = force + 0.005 * force.max() * np.random.default_rng(2).standard_normal(force.size)
    found = pl.fit(position, force, indenter=kind, radius="5 um", rivals=())
    assert holds(found.reduced_modulus, 4e3)
    assert holds(found.tension, 4e-3)


@pytest.mark.parametrize(("tension", "before"), [(0.0, 0.3), (TENSION, 0.3), (0.0, 99.0)])
def test_means_of_rows_answer_as_all_rows_do(
    tension: float, before: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a long curve, that may touch in its last hundredth, means lose little of the intervals."""
    rows = curve(tension, points=3000, noise=0.02, before=before)
    long = fit(*rows)
    monkeypatch.setattr("pellicle_fit.selection.rivals._FEW", 0)
    short = fit(*rows)
    assert short.answer.selected.objective.curves[0].force.size <= 400
    low, high = ends_of(long.reduced_modulus)
    for end in ("value", "low", "high"):
        off = getattr(short.reduced_modulus, end) - getattr(long.reduced_modulus, end)
        assert abs(off) < 0.05 * (high - low)


@pytest.mark.parametrize(
    ("aic", "verdict"),
    [
        ({"": 50, "a": 0, "b": 5}, Verdict.NEEDED),
        ({"": 50, "a": 0, "b": 3}, Verdict.CANNOT_TELL),
        ({"": 50, "a": 5, "b": 0}, Verdict.OTHER),
        ({"": 5, "a": 0, "b": 9}, Verdict.NO_SIGN),
        ({"": 5, "a": 2, "b": -6}, Verdict.NO_SIGN),
        ({"": 13, "a": 10, "b": 0}, Verdict.OTHER),
        # A pair counts if it is better than each of its parts, of many such.
        ({"": 50, "a": 20, "b": 12, "ab": 0}, Verdict.NEEDED),
        ({"": 50, "a": 20, "b": 11, "ab": 0}, Verdict.CANNOT_TELL),
        ({"": 50, "a": 20, "b": 5, "ab": 0}, Verdict.OTHER),
        # One that does without the solid is no explanation; one of a stiffer solid is.
        ({"": 50, "a": 20, "b": 12, "ab": (0, 0.1)}, Verdict.OTHER),
        ({"": 50, "a": 20, "b": 12, "ab": (0, 10.0)}, Verdict.NEEDED),
    ],
)
def test_verdicts_follow_from_criteria(aic: dict[str, Any], verdict: Verdict) -> None:
    """At the margins the verdict changes, and where the best fails its checks there is none.

    Beside an AIC stands the modulus over that of the others.
    """
    fits = {}
    for key, value in aic.items():
        types = frozenset(key)
        criterion, modulus = value if isinstance(value, tuple) else (value, 1.0)
        known = {"reduced_modulus": SimpleNamespace(value=modulus)}
        fit = SimpleNamespace(types=types, aic=criterion, parameters=known)
        fits[types] = cast("Candidate", fit)
    word = frozenset("a")
    assert decision(fits, word, inadequate=False, margin=4.0).verdict is verdict
    assert decision(fits, word, inadequate=True, margin=4.0).verdict is Verdict.UNDESCRIBED


def test_the_best_without_what_is_asked_for_is_at_its_minimum() -> None:
    """The verdict compares two minima, however far the other is behind."""
    known = truth_of("tension", np.random.default_rng(5))
    rows = fit_verdicts.rows_of("both", TOP)[0]
    force = known.force(rows)
    force = force + NOISE[1] * force.max() * np.random.default_rng(1).standard_normal(force.size)
    rivals = ["worn_tip", "softening"]
    found = fit(rows.depth, force, time=rows.time - rows.time[0], rivals=rivals, segment="both")
    assert found.verdict is Verdict.NEEDED
    decided = found.answer.decision
    for types in (decided.target, decided.other):
        (best,) = (e for e in found.answer.explanations if e.types == types)
        again = best.objective.minimise(best.minimum.at)
        assert best.minimum.chi_squared - again.chi_squared < 1e-4


def test_forecasts_bend_the_cantilever() -> None:
    """Base and force of a forecast obey z_tip = z_base − F/k, with k of the curve."""
    bent = fit(*curve(), spring_constant=0.02)
    for _, plan in measurements(bent.answer.selected):
        _, forecast = foretold(bent.answer.selected, plan)
        assert forecast.stiffness == 0.02
        np.testing.assert_allclose(forecast.base, plan.position, atol=1e-15)
        np.testing.assert_allclose(
            forecast.position, plan.position - forecast.force / 0.02, atol=1e-15
        )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "protocol", "verdict"),
    [
        ("hertz", "approach", "NO_SIGN"),
        ("tension", "both", "NEEDED"),
        ("power law", "both", "OTHER"),
        ("worn tip", "both", "OTHER"),
        ("adhesion", "both", "OTHER"),
        ("power law", "speeds", "OTHER"),
    ],
)
def test_verdicts_on_known_solids(kind: str, protocol: str, verdict: str) -> None:
    """A twentieth of tests/benchmarks/fit_verdicts.py, with all default rivals."""
    found = outcome(kind, protocol, number=1, seed=7)
    assert found["verdict"] == verdict
    # Of 95 % intervals one in twenty misses; none by more than three standard deviations.
    assert found["off"] < 3 / 1.96
    assert found["tension"]


def test_without_a_sign_the_modulus_is_that_without_what_was_asked_for() -> None:
    """The interval that a tension would make wider stands beside it, in words and as data."""
    rows = curve(0.0, noise=0.02)
    beside, alone = fit(*rows), fit(*rows, model=[])
    assert beside.verdict is Verdict.NO_SIGN
    quoted, plain = (
        np.array([e.value, *ends_of(e)]) for e in (beside.reduced_modulus, alone.reduced_modulus)
    )
    assert quoted == pytest.approx(plain, rel=1e-4)
    wide = beside.if_present["reduced_modulus"]
    assert ends_of(wide)[0] < quoted[1] - 0.1 * (quoted[2] - quoted[1])
    assert "if tension were there: tension < " in repr(beside)
    data = beside.to_dict()
    assert data["if_present"]["reduced_modulus"]["low"] == wide.low
    assert data["parameters"]["tension"]["high"] == beside.tension.high
    assert not alone.if_present


@settings(derandomize=True)
@given(
    st.lists(
        st.tuples(*[st.floats(-1.0, 1.0), *[st.none() | st.floats(0.01, 1.0)] * 2]),
        min_size=1,
        max_size=6,
    )
)
def test_a_common_value_lies_in_all_intervals_that_share_one(
    triples: list[tuple[float, float | None, float | None]],
) -> None:
    """Of explanations that tie the value is one that all allow; if there is none, none is told."""
    every = [
        Estimate(v, None if low is None else v - low, None if high is None else v + high, "Pa")
        for v, low, high in triples
    ]
    value = common_value(every)
    low = max([-np.inf, *(e.low for e in every if e.low is not None)])
    high = min([np.inf, *(e.high for e in every if e.high is not None)])
    assert np.isnan(value) == (low > high)
    if low <= high:
        assert low - 1e-9 <= value <= high + 1e-9


def test_ties_widen_the_interval() -> None:
    """An approach cannot tell a tension from a solid that relaxes; E* is that of both."""
    known = truth_of("tension", np.random.default_rng(5))
    (rows,) = fit_verdicts.rows_of("approach", TOP)
    force = known.force(rows)
    force = force + NOISE[1] * force.max() * np.random.default_rng(1).standard_normal(force.size)
    alone = fit(rows.depth, force, time=rows.time - rows.time[0])
    beside = fit(rows.depth, force, time=rows.time - rows.time[0], rivals=["power_law"])
    assert beside.verdict is Verdict.CANNOT_TELL
    assert len(beside.answer.tied) > 1
    assert ends_of(beside.reduced_modulus)[1] > ends_of(alone.reduced_modulus)[1]
    moduli = [fit.estimates["reduced_modulus"] for fit in beside.answer.tied]
    low, high = (max(e.low or 0 for e in moduli), min(e.high or np.inf for e in moduli))
    value = beside.reduced_modulus.value
    assert (low > high and np.isnan(value)) or low <= value <= high
    # A tension does not relax: the way back, or a dwell, tells it from a solid that does.
    proposal, curves = telling_measurement(beside.answer.target, beside.answer.tied_without)
    assert proposal
    assert proposal.means in (Means.RETRACTION, Means.DWELL)
    assert curves == 1


@pytest.mark.parametrize(("name", "share"), [("spring_constant", 0.1), ("radius", 0.1)])
def test_a_weighed_calibration_widens_the_modulus(name: str, share: float) -> None:
    """F ∝ k and, of Hertz, F ∝ E* R^½: what is known to a share leaves E* known to one or half."""
    position, force = curve(noise=0.002)
    sure = fit(position, force, fix={"tension": 0})
    weighed = fit(position, force, fix={"tension": 0}, uncertainty={name: share})
    assert weighed.reduced_modulus.value == pytest.approx(sure.reduced_modulus.value, rel=1e-3)
    low, high = ends_of(weighed.reduced_modulus)
    expected = 2 * 1.96 * share * {"spring_constant": 1.0, "radius": 0.5}[name]
    assert (high - low) / MODULUS == pytest.approx(expected, rel=0.15)


@pytest.mark.parametrize("moduli", [(MODULUS, MODULUS), (MODULUS, 1.2 * MODULUS)])
def test_curves_that_disagree_widen_what_they_share(moduli: tuple[float, float]) -> None:
    """Two curves of one modulus agree; of two that differ by 20 % the interval reaches further."""
    curves = {str(n): curve(seed=n, modulus=m) for n, m in enumerate(moduli)}
    pool = pl.fit_pooled(curves, indenter=BEAD, rivals=(), model=())
    low, high = ends_of(pool.reduced_modulus)
    assert ("do not agree" in pool.agreement) == (moduli[0] != moduli[1])
    assert ((high - low) / MODULUS > 0.05) == (moduli[0] != moduli[1])


@pytest.mark.parametrize(
    ("change", "flaw"),
    [
        (lambda z, f: f, None),
        (lambda z, f: f + 3e-11, Flaw.OFFSET),
        (lambda z, f: f + 0.1 * f.max() * np.linspace(0, 1, f.size), Flaw.DRIFT),
        (lambda z, f: f - 0.05 * f.max() * ((z > 0.97e-6) & (z < 1e-6)), Flaw.DIP),
        (lambda z, f: f * (1 - 0.4 * np.maximum(z - 1e-6, 0) / TOP), Flaw.PATTERN),
        (lambda z, f: np.where(np.arange(f.size) % 97, f, f + 0.2 * f.max()), Flaw.SPIKES),
        (lambda z, f: 0.04 * f.max() * np.round(f / (0.04 * f.max())), Flaw.STEPS),
        (lambda z, f: f + 0.01 * f.max() * np.convolve(WHITE, np.ones(15) / 4, "valid"), Flaw.SLOW),
    ],
)
def test_flaws_are_seen(change: Any, flaw: Flaw | None) -> None:
    """Each flaw of a curve without tension is named, and a clean curve has none."""
    position, force = curve(points=600)
    found = flaws(fit(position, change(position, force), model=()))
    assert flaw in found if flaw else not found


@pytest.mark.parametrize("noise", [3e-3, 0.03, 0.1])
@pytest.mark.parametrize("offset", [-0.5, 0.0, 5.0])
def test_a_baseline_without_contact_is_told(noise: float, offset: float) -> None:
    """One that slopes gives moduli, some of them narrow; no contact is as straight."""
    (position, force), random = curve(noise=noise), np.random.default_rng(5)
    line = np.linspace(0, 1, force.size) + offset + noise * random.standard_normal(force.size)
    told = [fit(position, f, model=()).messages for f in (1e-9 * line, force)]
    assert [any("no contact" in text for text in messages) for messages in told] == [True, False]


@pytest.mark.parametrize("tension", [0.0, TENSION])
@pytest.mark.parametrize("off", [0.0, -0.05, 0.05])
def test_a_contact_point_that_is_given_wrong_is_told(tension: float, off: float) -> None:
    """A twentieth of the depth makes a tension of nothing or hides one; 0 is not doubted."""
    position, force = curve(tension)
    rivals = ["rough_toe", "softening", "offset"]
    found = fit(position + off * TOP, force, rivals=rivals, fix={"contact_point": 1e-6})
    warned = [text for text in found.messages if "contact point is given" in text]
    assert bool(warned) == bool(off)
    assert not warned or ("tension" in warned[0]) == bool(tension)


def test_noise_of_1_over_f_is_taken_so() -> None:
    """Intervals of correlated noise hold the modulus, and are wider than those of white noise."""
    position, clean = curve(points=600, noise=0.0)
    random = np.random.default_rng(3)
    coloured = fit(position, clean + 0.005 * clean.max() * pink(random, 600), model=())
    assert coloured.answer.selected.objective.memory[0] > 0.2
    assert holds(coloured.reduced_modulus, MODULUS)
    white = fit(*curve(points=600), model=())
    assert np.ptp(ends_of(coloured.reduced_modulus)) > 2 * np.ptp(ends_of(white.reduced_modulus))


def test_a_cone_s_modulus_is_not_that_of_the_solid() -> None:
    """Its angle cannot be told, so that its modulus has no ends even where it is chosen."""
    position = np.linspace(-0.3e-6, 1e-6, 300)
    force = 1e3 * Cone(half_angle=1.0).force_curve(position, 0.0).force
    force += 0.003 * force.max() * np.random.default_rng(2).standard_normal(300)
    found = fit(position, force, rivals=["cone"])
    assert found.answer.selected.types == {"cone"}
    assert found.reduced_modulus.low is found.reduced_modulus.high is None
    assert found.reduced_modulus.ends == (End.ANOTHER, End.ANOTHER)


def test_relaxation_beside_a_tension_has_no_model_of_retraction() -> None:
    """Where no explanation describes both passes and that one was not tried, nothing is bounded."""
    (rows,) = fit_verdicts.rows_of("both", TOP)
    relaxing = fit_verdicts.closed_form("power_law", relaxation_exponent=0.2)
    force = relaxing(rows) + fit_verdicts.tensed(TENSION)(rows)
    force = force + 0.003 * force.max() * np.random.default_rng(2).standard_normal(force.size)
    time = rows.time - rows.time[0]
    found = fit(rows.depth, force, time=time, rivals=["power_law"], segment="both")
    assert found.verdict is Verdict.UNDESCRIBED
    assert found.answer.untried
    assert found.reduced_modulus.low is found.reduced_modulus.high is None


@pytest.mark.parametrize(
    "options",
    [{"thickness": "free", "poissons_ratio": 0.5}, {"model": ["brush"]}, {"rivals": ["layer"]}],
)
def test_of_what_no_model_describes_some_quantities_have_ends(options: Any) -> None:
    """Those that were asked for, and no others; all of it can be said."""
    position, force = curve()
    force = np.minimum(force, 0.9 * force.max())
    found = fit(position, force, baseline="offset", **options)
    assert found.verdict is Verdict.UNDESCRIBED
    assert "not to be quoted" in repr(found)
    assert "describes the curve" not in repr(found)
    always = {"reduced_modulus", "tension", "contact_point"}
    asked = always.union(found.answer.question.open_quantities)
    assert found.to_dict()["parameters"].keys() == asked & found.answer.selected.parameters.keys()


@pytest.mark.slow
def test_work_of_adhesion_is_held() -> None:
    """Where the jump stands out of the noise, modulus and work lie within their intervals."""
    work = 0.1 * float(hertz(TOP)) / (1.5 * np.pi * RADIUS)
    (rows,) = fit_verdicts.rows_of("both", TOP)
    force, held = fit_verdicts.closed_form("adhesion", work_of_adhesion=work)(rows), []
    for seed in range(10):
        noise = 0.005 * force.max() * np.random.default_rng(seed).standard_normal(force.size)
        found = fit(rows.depth, force + noise, model=["adhesion"], segment="both")
        held += [
            holds(found.reduced_modulus, MODULUS),
            holds(found.estimates()["work_of_adhesion"], work),
        ]
    assert sum(held) >= 17


@pytest.mark.parametrize("kind", ["power law", "standard linear"])
@pytest.mark.parametrize("rivals", [[], ["power_law"], ["standard_linear"]])
def test_noise_and_checks_say_the_same(kind: str, rivals: list[str]) -> None:
    """Of a solid that relaxes, on both passes: what is told is what is left, or a check fails."""
    random = np.random.default_rng(1)
    (rows,), known = fit_verdicts.rows_of("both", TOP), truth_of(kind, random)
    force = known.force(rows)
    noise = 0.004 * force.max()
    measured = force + noise * random.standard_normal(force.size)
    time = rows.time - rows.time[0]
    found = fit(rows.depth, measured, time=time, rivals=rivals, segment="both")
    left = measured - found.forces()[0]
    told = found.to_dict()["curves"][0]["noise"]["value"]
    assert 0.5 < np.std(left) / told < 1.3
    assert found.chi_squared / left.size == pytest.approx(np.mean(left**2) / told**2, rel=1e-6)
    is_right = rivals == [kind.replace(" ", "_")]
    assert (found.verdict is Verdict.UNDESCRIBED) != is_right
    assert bool(flaws(found)) != is_right


def test_a_curve_without_a_baseline_is_checked_too() -> None:
    """An offset that moves the contact before the first row leaves more than neighbours differ."""
    position, force = curve()
    for model in ([], ["tension"]):
        moved = fit(position, force + 3 * force.max(), model=model)
        assert moved.verdict is Verdict.UNDESCRIBED
        assert Flaw.MISFIT in flaws(moved)
    inside = position > 1e-6 + 0.1 * TOP
    assert holds(fit(position[inside], force[inside]).reduced_modulus, MODULUS)


@pytest.mark.parametrize(
    ("kind", "offset"),
    [("elastic", -20.0), ("relaxing", 0.2), ("relaxing", 20.0), ("adhesive", 0.2)],
)
def test_an_offset_that_the_curve_shows_changes_nothing(kind: str, offset: float) -> None:
    """A constant of the detector is no rival of what the solid does: all rivals act beside it."""
    position, force = curve()
    depth = np.maximum(position - 1e-6, 0.0) / TOP
    pushes = {"relaxing": force - 0.2 * force.max() * depth**1.5 * np.log1p(9 * depth)}
    pushes["adhesive"] = force - 0.05 * force.max() * (position > 1e-6)
    pushed = pushes.get(kind, force)
    known, found = (
        fit(position, pushed + shift * force.max(), rivals=DEFAULT_RIVALS, baseline=baseline)
        for shift, baseline in ((0.0, "offset"), (offset, "none"))
    )
    assert found.answer.selected.types - {"offset"} == known.answer.selected.types
    assert found.verdict is known.verdict
    a, b = known.reduced_modulus, found.reduced_modulus
    assert [b.low, b.high] == pytest.approx([a.low, a.high], rel=0.01)
    assert ("offset" in found.answer.selected.types) != ("offset" in found.data["baseline"])
