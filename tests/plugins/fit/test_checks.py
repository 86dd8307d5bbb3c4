"""What a curve shows of a wrong model, or of noise that is not independent, is said and counts."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fit_checks
import numpy as np
import pytest
from click.testing import Result
from fit_checks import CONTROLS, RIVALS, Kind, outcomes
from fit_rivals import MODULUS_ as MODULUS
from fit_rivals import RADIUS
from numpy.typing import NDArray

import pellicle as pl
from pellicle.units import Quantity
from pellicle_fit.models.force_model import tension_model
from pellicle_fit.statistics.likelihood import Likelihood
from pellicle_fit.statistics.noise import resolution
from pellicle_plugins.indenters.of_revolution import Cone, Paraboloid, Sphere
from tests.plugins.fit.conftest import ends_of, holds

Array = NDArray[np.float64]
MARKED = {name: kind for name, kind in RIVALS.items() if kind.leaves_mark}


def measured(kind: Kind, seed: int = 3) -> tuple[Array, Array]:
    """Return position and force of one curve of a kind."""
    return fit_checks.curve(kind, np.random.default_rng(seed))


def white(seed: int, *, length: float = 0.0, points: int = 600, noise: float = 0.005) -> Array:
    """Return position and force of a clean curve, as two rows."""
    depth = np.linspace(-0.3, 1.0, points) * 0.08 * RADIUS
    bead = Paraboloid(radius=RADIUS)
    force = MODULUS * bead.force_curve(depth, length).force
    errors = np.random.default_rng(seed).standard_normal(points)
    return np.array([depth + 1e-6, force + noise * force.max() * errors])


def fit(position: Array, force: Array, **options: Any) -> pl.Fit:
    """Return the fit by a paraboloid."""
    return pl.fit(position, force, indenter="paraboloid", radius=RADIUS, **options)


def codes(result: pl.Fit) -> list[str]:
    """Return the codes of the checks that fail."""
    return [check.code for check in result.failed_checks]


@pytest.mark.usefixtures("no_rivals")
@pytest.mark.parametrize("name", MARKED)
def test_no_tension_is_claimed_in_silence_where_the_curve_shows_another_cause(name: str) -> None:
    """Curves that bear a mark of what bends them are not said to need a tension without a word.

    A tenth of tests/benchmarks/fit_checks.py.
    """
    assert not any(outcome.is_silent for outcome in outcomes(MARKED[name], 3, seed=7))


@pytest.mark.slow
@pytest.mark.usefixtures("no_rivals")
@pytest.mark.parametrize("name", CONTROLS)
def test_curves_of_the_model_pass(name: str) -> None:
    """Curves that the model describes fail checks by chance only, and true tensions are claimed."""
    sample = list(outcomes(CONTROLS[name], 20, seed=7))
    assert sum(bool(outcome.failed) for outcome in sample) <= 1
    claims = sum(outcome.claims for outcome in sample)
    assert claims == 20 if name.startswith("tension") else claims <= 2


@pytest.mark.usefixtures("no_rivals")
@pytest.mark.parametrize("baseline", ["none", "offset", "slope"])
def test_dip_before_contact_is_adhesion_with_any_baseline(baseline: str) -> None:
    """A force below the baseline just before contact is adhesion, whatever baseline is fitted."""
    result = fit(*measured(RIVALS["dip of 1 % before contact"]), baseline=baseline)
    assert "adhesion" in codes(result)
    assert not result.tension_needed
    assert "tension is needed" not in result.comparison
    assert "adhesion" in result.to_dict()["failed_checks"][0]["code"]


@pytest.mark.usefixtures("no_rivals")
def test_advice_on_drift_mends_it() -> None:
    """A drift that an offset leaves is said with the baseline that fits it, which passes."""
    position, force = white(1)
    force = force + 0.1 * force.max() * np.linspace(0, 1, force.size)
    for baseline in ("none", "offset"):
        failed = {
            check.code: check.message
            for check in fit(position, force, baseline=baseline).failed_checks
        }
        assert "baseline 'slope'" in failed["drift"]
    assert not fit(position, force, baseline="slope").failed_checks


@pytest.mark.usefixtures("no_rivals")
def test_slope_that_takes_up_attraction_is_cautioned() -> None:
    """A fitted baseline that falls towards contact may be attraction, and one that rises not."""
    position, force = white(1)
    depth = position - 1e-6
    attracted = force - 0.02 * force.max() * np.exp(np.minimum(depth, 0.0) / (0.3 * depth[-1]))
    result = fit(position, attracted, baseline="slope")
    assert any("attraction of long range" in message for message in result.messages)
    risen = force + 0.02 * force.max() * np.linspace(0, 1, force.size)
    assert not fit(position, risen, baseline="slope").messages


@pytest.mark.usefixtures("no_rivals")
def test_offset_is_said_and_mended() -> None:
    """A baseline off 0 is said, with its value and the baseline that fits it."""
    position, force = white(2)
    shifted = force + 3e-11
    (check,) = [
        failure for failure in fit(position, shifted).failed_checks if failure.code == "offset"
    ]
    assert "the force before contact is 30.1 pN" in check.message
    assert not fit(position, shifted, baseline="offset").failed_checks


def test_offset_that_puts_contact_too_deep_is_suggested() -> None:
    """All rows of a force with an offset seem to touch, deeper than a ball has a side."""
    depth = np.linspace(-1.0, 0.5, 150) * RADIUS
    force = MODULUS * Sphere(radius=RADIUS).force_curve(depth, 0.0).force
    errors = 1e-3 * force.max() * np.random.default_rng(2).standard_normal(depth.size)
    measured = force + errors + force.max()
    options: dict[str, Any] = {"indenter": "sphere", "radius": RADIUS, "fix": {"tension": 0}}
    with pytest.raises(pl.ConfigError, match=r"ends at .* baseline 'offset'"):
        pl.fit(depth, measured, **options)
    modulus = pl.fit(depth, measured, baseline="offset", **options).reduced_modulus
    assert holds(modulus, MODULUS)


def test_noise_of_residuals_is_not_told_as_that_before_contact() -> None:
    """What a wrong model leaves in contact widens the noise, and is told beside the rows before."""
    position, force = white(1, length=0.3 * RADIUS)
    result = fit(position, force, fix={"tension": 0})
    before = float(np.std(force[position < 0.99e-6]))
    assert result.noise > 2 * before
    told = re.fullmatch(
        r"residuals in contact \((.+) from \d+ points before contact\); .*", result.noise_from
    )
    assert told
    assert float(Quantity("N")(told[1])) == pytest.approx(before, rel=0.1)
    assert not any("by that factor" in text for text in result.messages)


@pytest.mark.slow
@pytest.mark.usefixtures("no_rivals")
def test_correlated_noise_widens_and_white_noise_does_not() -> None:
    """Noise of the same size makes wider intervals where neighbours share it, and they hold."""
    covered = slow_noise = 0
    for seed in range(8):
        position, force = white(seed, length=0.3 * RADIUS)
        clean = white(seed, length=0.3 * RADIUS, noise=0.0)[1]
        random = np.random.default_rng(seed)
        slow = np.convolve(random.standard_normal(force.size + 14), np.ones(15), "valid")
        slow *= 0.005 * clean.max() / slow.std()
        independent, correlated = fit(position, force), fit(position, clean + slow)
        slow_noise += "slow_noise" in codes(correlated)
        assert correlated.failed_checks
        narrow, wide = (np.ptp(ends_of(f.reduced_modulus)) for f in (independent, correlated))
        assert wide > 2 * narrow
        covered += holds(correlated.reduced_modulus, MODULUS)
    assert covered >= 7
    assert slow_noise >= 7


@pytest.mark.usefixtures("no_rivals")
def test_steps_of_the_detector_are_seen() -> None:
    """Steps larger than the noise are said, and their rounding is the least noise."""
    position, force = white(4, length=0.3 * RADIUS, noise=0.001)
    step = 0.02 * force.max()
    rounded = step * np.round(force / step)
    result = fit(position, rounded)
    assert "steps" in codes(result)
    assert result.noise > 0.99 * step / np.sqrt(12)
    assert resolution(rounded) == pytest.approx(step)
    assert resolution(force) == 0


@pytest.mark.usefixtures("no_rivals")
def test_spikes_are_counted() -> None:
    """Rows far from both neighbours are said to be spikes."""
    position, force = white(5)
    force[[100, 300, 450]] += 0.2 * force.max()
    (spikes,) = [check for check in fit(position, force).failed_checks if check.code == "spikes"]
    assert spikes.message.startswith("3 points")


@pytest.mark.usefixtures("no_rivals")
def test_pattern_shows_without_rows_before_contact() -> None:
    """Where no row lies before contact a pattern in contact is still seen."""
    position, force = measured(RIVALS["softening by 15 %"])
    result = fit(position[300:], force[300:])
    assert any("0 points lie before contact" in message for message in result.messages)
    assert "pattern" in codes(fit(position[228:], force[228:]))


@pytest.mark.usefixtures("no_rivals")
@pytest.mark.parametrize(("depth", "ratio"), [(0.2, 0.95), (0.5, 0.87), (0.8, 0.78)])
def test_deep_paraboloid_says_what_a_sphere_changes(depth: float, ratio: float) -> None:
    """A ball fitted as a paraboloid seems too soft, and the sphere is named with its modulus."""
    ball = Sphere(radius=RADIUS)
    depths = np.linspace(-0.3, 1.0, 300) * depth * RADIUS
    force = MODULUS * ball.force_curve(depths, 0.0).force
    force += 0.001 * force.max() * np.random.default_rng(1).standard_normal(300)
    shallow = fit(depths, force)
    assert shallow.reduced_modulus.value / MODULUS == pytest.approx(ratio, abs=0.02)
    assert not shallow.tension_needed
    assert "shape" in codes(shallow)
    (message,) = [text for text in shallow.messages if "with indenter 'sphere'" in text]
    modulus = 1e3 * float(message.partition("reduced modulus is ")[2].partition(" kPa")[0])
    assert modulus == pytest.approx(MODULUS, rel=0.01)
    assert not any("sphere" in text for text in fit(*white(1)).messages)


@pytest.mark.slow
def test_tie_names_its_look_alikes_and_what_would_tell() -> None:
    """Where relaxation explains a curve as well, the fit says so, and which measurement tells."""
    result = fit(*white(5, length=0.3 * RADIUS))
    assert result.comparison.startswith("this curve cannot tell tension from power-law relaxation")
    assert "a dwell of" in result.comparison
    assert not result.tension_needed
    assert result.rivals is not None
    assert {"tension", "power_law"} <= {rival_fit.rival.code for rival_fit in result.rivals.tied}
    alternatives = {rival_fit.rival.code for rival_fit in result.rivals.alternatives}
    pairs = {"tension+power_law", "tension+adhesion"}
    assert alternatives == {"tension", "power_law", *pairs}
    assert result.range_of_models().startswith("over 4 models that the data cannot tell apart")
    (low, high), own = ends_of(result.rivals.modulus), ends_of(result.reduced_modulus)
    # Both intervals are searched, to a share of 1e-4.
    assert low <= own[0] * (1 + 1e-4)
    assert high >= own[1] * (1 - 1e-4)


@pytest.mark.slow
def test_range_of_tied_models_is_the_union_of_their_intervals() -> None:
    """It is sought only where a model reaches beyond the others, with the same ends."""
    curve = white(5, length=0.3 * RADIUS)
    short, full = fit(*curve).rivals, fit(*curve, compare=True).rivals
    assert short is not None
    assert full is not None
    tied = {rival_fit.rival.code for rival_fit in short.alternatives}
    own = [f.estimates["reduced_modulus"] for f in full.fits if f.rival.code in tied]
    assert len(own) == len(tied) > 1
    lows, highs = zip(*((estimate.low, estimate.high) for estimate in own), strict=True)
    assert max(lows) > 1.2 * min(lows)
    assert ends_of(short.modulus) == pytest.approx((min(lows), max(highs)), rel=1e-3)


@pytest.mark.slow
def test_tables_and_pools_carry_failed_checks(cli: Callable[..., Result], tmp_path: Path) -> None:
    """CSV and JSON of many curves and of a pool hold code and sentence of each failed check."""
    curves = {
        "dip.csv": measured(RIVALS["dip of 1 % before contact"]),
        "clean.csv": tuple(white(5, length=0.3 * RADIUS)),
    }
    for name, columns in curves.items():
        rows = np.column_stack([1e6 * columns[0], 1e9 * columns[1]])
        header = "position [um],force [nN]"
        np.savetxt(name, rows, delimiter=",", header=header, comments="", fmt="%.12g")
    common = ("dip.csv", "clean.csv", "-i", "paraboloid", "--radius", "5 um", "-o", "out")
    assert "adhesion" in cli(*common).stdout
    with Path("out/fits.csv").open(encoding="utf-8") as file:
        dip, clean = csv.DictReader(file)
    assert "adhesion" in dip["failed_checks"].split("; ")
    assert clean["failed_checks"] == ""
    assert (float(dip["tension_needed"]), float(clean["tension_needed"])) == (0, 0)
    assert "cannot tell" in clean["comparison"]
    rows_of_json = json.loads(Path("out/fits.json").read_text(encoding="utf-8"))["curves"]
    cli(*common, "--pool")
    pool = json.loads(Path("out/pool.json").read_text(encoding="utf-8"))
    for row in (rows_of_json[0], pool["curves"][0]):
        check = row["failed_checks"][0]
        assert check["code"] == "adhesion"
        assert check["message"] in row["messages"]
    assert not pool["tension_needed"]


@pytest.mark.slow
def test_pool_of_curves_that_fail_needs_no_tension() -> None:
    """Where more curves of a pool fail a check than by chance, it claims no tension."""
    softening = RIVALS["softening by 15 %"]
    curves = {f"{seed}.csv": measured(softening, seed) for seed in (1, 2)}
    pool = pl.fit_pooled(curves, indenter="paraboloid", radius=RADIUS)
    assert pool.tension.low is not None
    assert not pool.tension_needed
    assert "better than tension" in pool.comparison


def _cantilever(stiffness: float) -> tuple[Array, Array]:
    """Return position and force of a solid that stiffens, under a soft cantilever, with noise."""
    base = np.linspace(-0.3, 1.0, 200) * 1.5e-6
    seen = 0.8 * stiffness * 1.5e-6 * np.maximum(base / 1.5e-6, 0.0) ** 2.2
    seen += 0.005 * seen.max() * np.random.default_rng(3).standard_normal(base.size)
    return base - seen / stiffness, seen


@pytest.mark.slow
def test_fit_with_a_cantilever_and_a_baseline_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """A curve that the model cannot describe takes no more than thousands of evaluations."""
    count = 0
    whole = Likelihood._elastic

    def counted(*arguments: Any) -> object:
        nonlocal count
        count += 1
        assert count < 30_000
        return whole(*arguments)

    monkeypatch.setattr(Likelihood, "_elastic", counted)
    result = fit(*_cantilever(5e-4), spring_constant=5e-4, baseline="slope")
    assert result.failed_checks


def test_slope_of_the_baseline_cannot_reproduce_any_curve() -> None:
    """The baseline runs along the base of the cantilever, which holds no measured force."""
    position, force = _cantilever(1e-3)
    bead = Paraboloid(radius=RADIUS)
    likelihood = Likelihood(position, force, tension_model(bead), 1e-10, (), 1e-3)
    steps = np.diff(likelihood.travel)
    assert np.ptp(steps) < 1e-9 * steps.mean()


@pytest.mark.usefixtures("no_rivals")
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda z, f: (z, f + 0j), "force: holds complex numbers"),
        (lambda z, f: (z + 0j, f), "position: holds complex numbers"),
        (lambda z, f: (z, f * np.nan), "at least 8"),
    ],
)
def test_values_that_are_no_forces_are_refused(
    change: Callable[[Array, Array], tuple[Array, Array]], words: str
) -> None:
    """Complex numbers and NaN are refused in words."""
    with pytest.raises(pl.ConfigError, match=words):
        fit(*change(*white(1)))


@pytest.mark.usefixtures("no_rivals")
@pytest.mark.parametrize(
    ("factor", "words"),
    [(1.0, ""), (1e-4, "a modulus below 3.46 mPa is not plausible: are the units right?")],
)
def test_only_a_whole_interval_is_implausible(factor: float, words: str) -> None:
    """The best value of an interval that is open there is one of many, not a wrong unit."""
    depth, modulus, tension = np.linspace(-1e-6, 0.4e-6, 300), 1e-3, 5e-3
    force = modulus * Paraboloid(radius=5e-6).force_curve(depth, 2 * tension / modulus).force
    noise = 0.02 * force.max() * np.random.default_rng(4).standard_normal(depth.size)
    result = pl.fit(depth, factor * (force + noise), indenter="paraboloid", radius=5e-6)
    assert result.reduced_modulus.value < 1.0
    assert result.reduced_modulus.low is None
    assert [text for text in result.warnings if "plausible" in text] == [words] * bool(words)
    bound = "34.6 Pa" if factor == 1 else "3.46 mPa"
    assert any(f"the modulus is open (it is below {bound})" in text for text in result.warnings)


@pytest.mark.slow
@pytest.mark.usefixtures("no_rivals")
def test_no_interval_is_narrower_than_its_bound() -> None:
    """Near the end of a tension, and where a model is far from linear, no bound is given."""
    cone = Cone(half_angle=1.2)
    for seed in range(12):
        depth = np.linspace(-0.3, 1.0, 60) * 0.04e-6
        force = MODULUS * cone.force_curve(depth, 0.0).force
        force += 0.02 * force.max() * np.random.default_rng(seed).standard_normal(60)
        result = pl.fit(depth, force, indenter=cone)
        for name, estimate in result.estimates().items():
            low = 0.0 if name == "tension" and estimate.low is None else estimate.low
            if low is None or estimate.high is None or not np.isfinite(estimate.bound):
                continue
            reach = max(estimate.high - estimate.value, estimate.value - low)
            assert reach >= estimate.bound


@pytest.mark.slow
def test_a_curve_without_noise_has_no_steps() -> None:
    """Equal forces before contact are no steps of a detector where the others lie anywhere."""
    position, force = white(4, length=0.3 * RADIUS, noise=0)
    assert (force == 0).sum() > 50
    assert resolution(force) == 0
    assert "steps" not in codes(fit(position, force))
