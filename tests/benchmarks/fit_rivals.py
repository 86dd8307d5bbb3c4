"""How often fits claim a tension that is not there, on curves of other solids than their own.

A curve is its approach alone if its kind does not say otherwise; where the answer is that it cannot
tell, the measurement that it names is added.  Forces come from closed forms: the power law by an
incomplete beta function, adhesion and the layer by the integral equation.
Run it: ``python tests/benchmarks/fit_rivals.py [curves of each kind [seed [names of kinds]]]``.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import beta, betainc
from tables import curves_of_kinds, print_head, print_row

import pellicle as pl
from pellicle.components import HasForceCurve, HasLayerForceCurve
from pellicle.units import Quantity
from pellicle_fit.files.measurement import Measurement
from pellicle_fit.files.sources import Source
from pellicle_fit.models.force_model import tension_model
from pellicle_fit.parameters import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION
from pellicle_fit.pooled import pool_sources
from pellicle_fit.statistics.likelihood import Likelihood
from pellicle_plugins.axisymmetric.adhesive_contact import Adhesion

Array = NDArray[np.float64]
Force = Callable[[Array, Array, float], Array]
"""Force over Hertz at the largest depth, of depths over the largest, times and sense of motion."""
RADIUS, MODULUS_ = 5e-6, 2e3
POINTS, BEFORE = 1000, 0.3
"""Rows of a pass, and range before contact over that in it."""
NOISE = 0.003, 0.01
"""Least and greatest noise, over the largest force."""
DEPTH = 0.08
"""Largest depth over R."""


class Path(NamedTuple):
    """Depth over the largest, time since contact over that of the approach, and sense of motion."""

    depth: Array
    time: Array
    sense: Array
    rate: float = 1.0
    """Speed over that of the first approach."""
    radius: float = 1.0
    """Radius of the indenter over that of the first approach."""

    @property
    def top(self) -> float:
        """Time at which the indenter stops to move in."""
        return float(self.depth.max()) / self.rate


def path(
    segment: str = "approach",
    rate: float = 1.0,
    dwell: bool = False,
    deepest: float = 1.0,
    radius: float = 1.0,
) -> Path:
    """Return the rows of an approach, a retraction, both, or an approach and a dwell."""
    down = deepest * np.linspace(-BEFORE, 1.0, POINTS)
    if dwell:
        resting = np.linspace(0, 1 + BEFORE, POINTS)
        return Path(
            np.concatenate([down, np.ones(POINTS)]),
            np.concatenate([down, 1 + resting]) / rate,
            np.concatenate([np.ones(POINTS), np.zeros(POINTS)]),
            rate,
        )
    if segment == "approach":
        return Path(down, down / rate, np.ones(POINTS), rate, radius)
    return Path(
        np.concatenate([down, down[::-1]]),
        np.concatenate([down, 2 - down[::-1]]) / rate,
        np.concatenate([np.ones(POINTS), -np.ones(POINTS)]),
        rate,
    )


class Truth(NamedTuple):
    """One solid under one instrument."""

    force: Callable[[Path], Array]
    """Force over that of Hertz at the largest depth."""
    codes: tuple[str, ...]
    """Names of the models that are right."""
    depth: float = DEPTH
    indenter: str = "paraboloid"
    coloured: bool = False
    tension: float = 0.0
    """s/R."""
    noise: float | None = None
    """Over the largest force; drawn if None."""


def _hertz(path: Path) -> Array:
    return np.asarray(np.sqrt(path.radius) * np.maximum(path.depth, 0.0) ** 1.5)


def _clean(random: np.random.Generator) -> Truth:
    return Truth(_hertz, ("none",))


def tensed_at(ratio: float) -> Truth:
    """Return a solid under the tension at which s/R is a ratio."""

    def force(path: Path) -> Array:
        curve = shape("paraboloid", path.radius).force_curve(
            path.depth * DEPTH * RADIUS, ratio * RADIUS
        )
        return curve.force / hertz_scale(DEPTH)

    return Truth(force, ("tension",), tension=ratio)


def _tensed(random: np.random.Generator) -> Truth:
    return tensed_at(float(np.exp(random.uniform(np.log(0.03), np.log(1.0)))))


def _five_errors(protocol: str) -> Callable[[np.random.Generator], Truth]:
    def truth(random: np.random.Generator) -> Truth:
        noise = random.uniform(*NOISE)
        return tensed_at(five_errors(protocol, noise))._replace(noise=noise)

    return truth


def five_errors(protocol: str, noise: float) -> float:
    """Return s/R at which the tension is five times its Cramér–Rao bound."""
    low, high = 1e-5, 1.0
    rows = path("both" if protocol == "both" else "approach")
    # Two curves with contact points of their own have twice the information.
    gain = np.sqrt(2) if protocol == "speeds" else 1.0
    for _ in range(20):
        ratio = float(np.sqrt(low * high))
        truth = tensed_at(ratio)
        depth = rows.depth * DEPTH * RADIUS
        scale = MODULUS_ * hertz_scale(DEPTH)
        tension = ratio * RADIUS * MODULUS_ / 2
        curve = Likelihood(
            depth,
            truth.force(rows) * scale,
            tension_model(shape("paraboloid")),
            noise * scale * float(truth.force(rows).max()),
            (CONTACT_POINT, MODULUS, TENSION),
            segment="both" if protocol == "both" else "approach",
        )
        at = {
            CONTACT_POINT: 0.0,
            MODULUS: np.log(MODULUS_),
            TENSION: tension,
            OFFSET: 0.0,
            SLOPE: 0.0,
        }
        bound = curve.bounds(at, curve.free)[TENSION] / gain
        low, high = (ratio, high) if tension < 5 * bound else (low, ratio)
    return ratio


def hertz_scale(depth: float) -> float:
    """Return the force over E* of Hertz at a depth over R [m²]."""
    return 4 / 3 * float(np.sqrt(RADIUS) * (depth * RADIUS) ** 1.5)


def _relaxed(
    path: Path, response: Callable[[Array, Array], Array], primitive: Callable[[Array], Array]
) -> Array:
    """Return the force of a solid that relaxes, by Lee & Radok and Ting.

    ``response(t, t1)`` is ∫ E(t − t′) d(t′^1.5) up to t1, in units of the approach.
    """
    time, top = np.maximum(path.time, 0.0), path.top
    last = np.minimum(time, top)
    out = path.sense < 0
    t = time[out]
    low, high = np.full(t.size, -1e-9), np.full(t.size, top)
    for _ in range(60):
        middle = (low + high) / 2
        # ∫ E(t − t′) dδ over the growth from t1 on and over the retraction.
        growth = primitive(t - middle) - 2 * primitive(t - top)
        low, high = np.where(growth > 0, middle, low), np.where(growth > 0, high, middle)
    last[out] = np.maximum(low, 0.0)
    force = np.sqrt(path.radius) * path.rate**1.5 * response(time, last)
    return np.where(path.time > 0, force, 0.0)


def _power_law(random: np.random.Generator) -> Truth:
    alpha = float(random.choice([0.1, 0.2, 0.3]))
    whole = 1.5 * beta(1.5, 1 - alpha)

    def response(t: Array, t1: Array) -> Array:
        share = np.divide(t1, t, out=np.zeros_like(t), where=t > 0)
        return np.asarray(t ** (1.5 - alpha) * whole * betainc(1.5, 1 - alpha, share))

    def force(path: Path) -> Array:
        return _relaxed(path, response, lambda t: t ** (1 - alpha))

    return Truth(force, ("power_law",))


def _standard_linear(random: np.random.Generator) -> Truth:
    share, constant = random.uniform(0.15, 0.6), float(np.exp(random.uniform(np.log(0.05), 0.0)))
    nodes, weights = np.polynomial.legendre.leggauss(80)
    u, weights = (nodes[:, None] + 1) / 2, weights / 2

    def response(t: Array, t1: Array) -> Array:
        kept = 1 - share + share * np.exp(-(t - t1 * u**2) / constant)
        return np.asarray(t1**1.5 * (weights @ (3 * u**2 * kept)))

    def primitive(t: Array) -> Array:
        return (1 - share) * t - share * constant * np.expm1(-t / constant)

    return Truth(lambda path: _relaxed(path, response, primitive), ("standard_linear",))


def _drag(random: np.random.Generator) -> Truth:
    share = random.uniform(0.02, 0.15)

    def force(path: Path) -> Array:
        radius = np.sqrt(path.radius * np.maximum(path.depth, 0.0))
        return _hertz(path) + share * path.rate * path.sense * radius

    return Truth(force, ("drag",))


def _drift(random: np.random.Generator) -> Truth:
    across = float(random.choice([-1, 1]) * random.uniform(0.01, 0.05))

    def force(path: Path) -> Array:
        return _hertz(path) + across * (path.depth + BEFORE) / (1 + BEFORE)

    return Truth(force, ("baseline_slope",))


def _layer(random: np.random.Generator) -> Truth:
    # Thickness over contact radius at the largest depth; that of an expansion in their ratio would
    # be 1 to 3 % off.
    thickness = random.uniform(3.0, 10.0) * float(np.sqrt(DEPTH)) * RADIUS

    def force(path: Path) -> Array:
        body = shape("paraboloid", path.radius)
        assert isinstance(body, HasLayerForceCurve)
        depth = path.depth * DEPTH * RADIUS
        return body.layer_force_curve(depth, 0.0, thickness, 0.5).force / hertz_scale(DEPTH)

    return Truth(force, ("thickness",))


def _ball(random: np.random.Generator) -> Truth:
    deepest = random.uniform(0.2, 0.8)

    def force(path: Path) -> Array:
        curve = shape("sphere", path.radius).force_curve(path.depth * deepest * RADIUS, 0.0)
        return curve.force / hertz_scale(deepest)

    return Truth(force, ("sphere",), depth=deepest)


def _pink_noise(random: np.random.Generator) -> Truth:
    return Truth(_hertz, ("none",), coloured=True)


def _adhesion(tensed: bool) -> Callable[[np.random.Generator], Truth]:
    def truth(random: np.random.Generator) -> Truth:
        share = random.uniform(0.02, 0.1)
        ratio = float(np.exp(random.uniform(np.log(0.03), np.log(1.0)))) if tensed else 0.0
        top = MODULUS_ * hertz_scale(DEPTH)
        tension = ratio * RADIUS * MODULUS_ / 2
        work = share * top / (1.5 * np.pi * RADIUS)

        def force(path: Path) -> Array:
            indenter: Any = shape("paraboloid", path.radius)
            theory = Adhesion(indenter, MODULUS_, tension, work)
            end = theory.instability(np.inf)
            branch = theory.equilibrium(np.geomspace(float(end.contact_radius), RADIUS, 3000))
            depth = path.depth * DEPTH * RADIUS
            touches = np.where(path.sense < 0, depth > branch.depth[0], depth > 0)
            return np.where(touches, np.interp(depth, branch.depth, branch.force), 0.0) / top

        return Truth(force, ("tension+adhesion" if tensed else "adhesion",), tension=ratio)

    return truth


@cache
def shape(type_: str, radius: float = 1.0) -> HasForceCurve:
    """Return a shape of a radius over the first."""
    indenter = pl.indenter(type_, radius=radius * RADIUS)
    assert isinstance(indenter, HasForceCurve)
    return indenter


def pink_noise(random: np.random.Generator, points: int) -> Array:
    """Return noise of variance 1 whose power falls as 1/f."""
    frequencies = np.fft.rfftfreq(4 * points)
    frequencies[0] = np.inf
    parts = random.standard_normal((2, frequencies.size)) / np.sqrt(frequencies)
    noise: Array = np.fft.irfft(parts[0] + 1j * parts[1])[:points]
    return np.asarray((noise - noise.mean()) / noise.std())


KINDS: dict[str, Callable[[np.random.Generator], Truth]] = {
    "no tension": _clean,
    "power law": _power_law,
    "standard linear": _standard_linear,
    "drag": _drag,
    "adhesion": _adhesion(tensed=False),
    "drift": _drift,
    "layer": _layer,
    "sphere as a paraboloid": _ball,
    "1/f noise": _pink_noise,
    "tension, s/R 0.03 to 1": _tensed,
    "tension and adhesion": _adhesion(tensed=True),
    "tension, 5 errors of an approach": _five_errors("approach"),
    "tension, 5 errors of both passes": _five_errors("both"),
    "tension, 5 errors of two speeds": _five_errors("speeds"),
    "both passes, 5 errors of an approach": _five_errors("approach"),
    "two speeds, 5 errors of an approach": _five_errors("approach"),
}
PROTOCOLS = {
    "tension, 5 errors of both passes": "both",
    "tension, 5 errors of two speeds": "speeds",
    "both passes, 5 errors of an approach": "both",
    "two speeds, 5 errors of an approach": "speeds",
}
"""What is measured first, if not an approach."""


class Curve(NamedTuple):
    """Position [m], force [N] and time [s] of a measurement, and which passes it has."""

    position: Array
    force: Array
    time: Array
    segment: str = "approach"
    radius: float = 1.0
    """Of the indenter, over the first."""


@dataclass
class Sample:
    """A solid, and measurements of it with noise of one size."""

    truth: Truth
    random: np.random.Generator

    def __post_init__(self) -> None:
        known = self.truth.noise
        self.noise = self.random.uniform(*NOISE) if known is None else known

    def measured(self, rows: Path) -> Curve:
        """Return a measurement along a path; the approach at the first speed takes 1 s."""
        force = self.truth.force(rows)
        top = float(np.abs(self.truth.force(path())).max())
        size = force.size
        noise = (
            pink_noise(self.random, size)
            if self.truth.coloured
            else self.random.standard_normal(size)
        )
        deepest = self.truth.depth * RADIUS
        scale = MODULUS_ * hertz_scale(self.truth.depth)
        return Curve(
            rows.depth * deepest + 1e-6,
            scale * (force + self.noise * top * noise),
            rows.time + 1.0,
            "approach" if rows.sense.min() > 0 else "both",
            rows.radius,
        )


def fitted(sample: Sample, curve: Curve, segment: str = "approach", **options: Any) -> pl.Fit:
    """Return the fit of one measurement."""
    return pl.fit(
        curve.position,
        curve.force,
        time=curve.time,
        indenter=sample.truth.indenter,
        radius=RADIUS,
        segment=segment,
        **options,
    )


class Outcome(NamedTuple):
    """What the fit of a curve says, and that with the measurement that it names."""

    verdict: str
    named: str
    """The measurement, in words; empty if none."""
    tied: tuple[str, ...]
    second: str
    """The verdict with that measurement."""
    right: bool
    """Whether the right model is the best or tied with it."""
    covers: bool
    """Whether the interval of the modulus holds the truth."""
    decided: bool
    """Whether the interval is that of one model, not of several that are tied."""
    seconds: float

    def settled(self, needed: bool) -> bool:
        """Return whether the verdict with the measurement is the right one."""
        return (self.second == "needed") == needed and self.second != "undecided"


def verdict_of(fit: Any) -> str:
    """Return the verdict of a fit or a pooled fit."""
    return fit.rivals.verdict if fit.rivals is not None else "not shown"


def outcomes(name: str, curves: int, seed: int, *, follow: bool = True) -> Iterator[Outcome]:
    """Yield what fits say of curves of a kind."""
    for number in range(curves):
        yield outcome_of(name, number, seed, follow=follow)


def outcome_of(name: str, number: int, seed: int, *, follow: bool = True) -> Outcome:
    """Return what the fit of one curve of a kind says."""
    random = np.random.default_rng([seed, number, *name.encode()])
    sample = Sample(KINDS[name](random), random)
    return outcome(sample, PROTOCOLS.get(name, "approach"), follow=follow)


def outcome(sample: Sample, protocol: str = "approach", *, follow: bool = True) -> Outcome:
    """Return what the fit of one curve, or of two at two speeds, says."""
    began = process_time()
    fit: Any
    if protocol == "speeds":
        curves = [sample.measured(path(rate=rate)) for rate in (1.0, 0.1)]
        fit = pooled(sample, curves)
    else:
        curves = [sample.measured(path(protocol))]
        fit = fitted(sample, curves[0], protocol)
    seconds = process_time() - began
    verdict = verdict_of(fit)
    rivals = fit.rivals
    tied = tuple(tie.rival.code for tie in rivals.tied) if rivals is not None else ("none",)
    covers = holds(modulus_of(fit))
    named = rivals.advice if rivals is not None else ""
    second = ""
    if follow and verdict == "undecided" and named and (more := followed(sample, curves, named)):
        second = verdict_of(more)
    right = verdict == "not shown" or any(code in tied for code in sample.truth.codes)
    decided = rivals is None or rivals.modulus is None
    return Outcome(verdict, named, tied, second, right, covers, decided, seconds)


def modulus_of(fit: pl.Fit | pl.PooledFit) -> pl.Estimate:
    """Return the modulus over all explanations that the fit cannot tell apart."""
    if fit.rivals is not None and fit.rivals.modulus is not None:
        return fit.rivals.modulus
    return fit.chosen_estimates()["reduced_modulus"]


def holds(estimate: pl.Estimate) -> bool:
    """Return whether an interval holds the true modulus."""
    return (estimate.low or 0.0) <= MODULUS_ <= (estimate.high or np.inf)


def followed(sample: Sample, curves: Sequence[Curve], named: str) -> pl.Fit | pl.PooledFit | None:
    """Return the fit with the measurement that a fit names; None if it names none."""
    count = int(named.split()[0]) if "curves of this kind" in named else 1
    more = named_path(sample, named)
    if more is None:
        return None
    if count == 1 and len(curves) == 1 and more.sense.min() <= 0:
        # One measurement has the approach in it.
        curve = sample.measured(more)
        return fitted(sample, curve, "both")
    return pooled(sample, [*curves, *(sample.measured(more) for _ in range(count))])


def named_path(sample: Sample, named: str) -> Path | None:
    """Return the path of the measurement that a fit names."""
    deepest = sample.truth.depth * RADIUS
    if "retraction" in named:
        return path("both")
    if "dwell" in named:
        return path(dwell=True)
    if speed := re.search(r"second speed of (\S+ \S+m/s)", named):
        return path(rate=10.0 if Quantity("m/s")(speed[1]) > deepest else 0.1)
    if depth := re.search(r"curve, to (\S+ \S*m)\b", named):
        return path(deepest=Quantity("m")(depth[1]) / deepest)
    if radius := re.search(r"second radius, (\S+ \S*m)\b", named):
        return path(radius=Quantity("m")(radius[1]) / RADIUS)
    return None


def pooled(sample: Sample, curves: Sequence[Curve], **options: Any) -> pl.PooledFit:
    """Return the pooled fit of several measurements."""
    segment = "both" if any(curve.segment == "both" for curve in curves) else "approach"
    config = pl.FitConfig.merged(
        indenter=sample.truth.indenter, radius=RADIUS, segment=segment, pool=True, **options
    )
    sources = [
        Source(
            str(n),
            Measurement(curve.position, curve.force, time=curve.time),
            {"radius": curve.radius * RADIUS},
        )
        for n, curve in enumerate(curves)
    ]
    return pool_sources(config, sources, progress=False)


def print_outcomes(name: str, results: Sequence[Outcome]) -> None:
    """Print the row of a kind."""
    needed = "tension" in KINDS[name](np.random.default_rng(0)).codes[0]
    columns = [
        Counter(result.verdict for result in results),
        Counter(result.second for result in results if result.second),
        Counter(" ".join(result.named.split()[:4]) for result in results if result.named),
    ]
    cells = [", ".join(f"{n} {key}" for key, n in count.items()) for count in columns]
    second = [r for r in results if r.second]
    settled = [result.settled(needed) for result in second]
    claims = [needed or "needed" not in (result.verdict, result.second) for result in results]
    decided = [result.covers for result in results if result.decided]
    shares = [
        100 * np.mean(flags) if len(flags) else np.nan
        for flags in (np.logical_not(claims), settled, [r.right for r in results])
    ]
    cells += [f"{share:.0f} %" for share in shares]
    cells += [f"{sum(decided)} of {len(decided)}"]
    cells += [f"{sum(r.covers for r in results if not r.decided)} of {len(results) - len(decided)}"]
    print_row(name, *cells, f"{np.median([result.seconds for result in results]):.2f}")


def main() -> None:
    """Print a row of a table for each kind."""
    curves, seed, kinds = curves_of_kinds(__doc__, list(KINDS), 20, 7)
    print_head(
        *(f"{curves} curves each", "first answer", "with the measurement named", "named", "false"),
        *("settled", "right", "E* of one model holds", "E* over tied models holds", "CPU s"),
    )
    for name in kinds:
        print_outcomes(name, list(outcomes(name, curves, seed)))


if __name__ == "__main__":
    main()
