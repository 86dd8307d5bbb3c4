"""How often fits claim a tension that is not there, on curves of other solids than their own.

Each curve is fitted by its approach alone; where the answer is that it cannot tell, the measurement
that it names is added.  Forces come from closed forms: the power law by an incomplete beta
function, adhesion by the integral equation, the layer by Dimitriadis et al. (2002).  Run it:
``python tests/benchmarks/fit_rivals.py [curves of each kind [seed [names of kinds]]]``.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import beta, betainc

import pellicle as pl
from pellicle.components import HasForceCurve
from pellicle.fitting.models.force_model import tension_model
from pellicle.fitting.parameters import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION
from pellicle.fitting.statistics.likelihood import Likelihood
from pellicle_plugins.analytic.adhesion import Adhesion

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
_DEFAULT = 20, 7


class Path(NamedTuple):
    """Depth over the largest, time since contact over that of the approach, and sense of motion."""

    depth: Array
    time: Array
    sense: Array
    rate: float = 1.0
    """Speed over that of the first approach."""


def path(segment: str = "approach", rate: float = 1.0, dwell: bool = False) -> Path:
    """Return the rows of an approach, a retraction, both, or an approach and a dwell."""
    down = np.linspace(-BEFORE, 1.0, POINTS)
    if dwell:
        held = np.linspace(0, 1 + BEFORE, POINTS)
        return Path(
            np.concatenate([down, np.ones(POINTS)]),
            np.concatenate([down, 1 + held]) / rate,
            np.concatenate([np.ones(POINTS), np.zeros(POINTS)]),
            rate,
        )
    if segment == "approach":
        return Path(down, down / rate, np.ones(POINTS), rate)
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


def _hertz(depth: Array) -> Array:
    return np.maximum(depth, 0.0) ** 1.5


def _clean(random: np.random.Generator) -> Truth:
    return Truth(lambda path: _hertz(path.depth), ("none",))


def _tensed_at(ratio: float) -> Truth:
    def force(path: Path) -> Array:
        curve = _shape("paraboloid").force_curve(path.depth * DEPTH * RADIUS, ratio * RADIUS)
        return curve.force / _scale(DEPTH)

    return Truth(force, ("tension",), tension=ratio)


def _tensed(random: np.random.Generator) -> Truth:
    return _tensed_at(float(np.exp(random.uniform(np.log(0.03), np.log(1.0)))))


def _five_errors(segment: str) -> Callable[[np.random.Generator], Truth]:
    def truth(random: np.random.Generator) -> Truth:
        return _tensed_at(five_errors(segment, 0.0065))

    return truth


@cache
def five_errors(segment: str, noise: float) -> float:
    """Return s/R at which the tension is five times its Cramér–Rao bound."""
    low, high = 1e-5, 1.0
    rows = path(segment)
    for _ in range(40):
        ratio = float(np.sqrt(low * high))
        truth = _tensed_at(ratio)
        depth = rows.depth * DEPTH * RADIUS
        scale = MODULUS_ * _scale(DEPTH)
        tension = ratio * RADIUS * MODULUS_ / 2
        curve = Likelihood(
            depth,
            truth.force(rows) * scale,
            tension_model(_shape("paraboloid")),
            noise * scale * float(truth.force(rows).max()),
            (CONTACT_POINT, MODULUS, TENSION),
            segment="both" if segment == "both" else "approach",
        )
        at = {
            CONTACT_POINT: 0.0,
            MODULUS: np.log(MODULUS_),
            TENSION: tension,
            OFFSET: 0.0,
            SLOPE: 0.0,
        }
        bound = curve.bounds(at, curve.free)[TENSION]
        low, high = (ratio, high) if tension < 5 * bound else (low, ratio)
    return ratio


def _scale(depth: float) -> float:
    """Return the force over E* of Hertz at a depth over R [m²]."""
    return 4 / 3 * float(np.sqrt(RADIUS) * (depth * RADIUS) ** 1.5)


def _relaxed(
    path: Path, response: Callable[[Array, Array], Array], primitive: Callable[[Array], Array]
) -> Array:
    """Return the force of a solid that relaxes, by Lee & Radok and Ting.

    ``response(t, t1)`` is ∫ E(t − t′) d(t′^1.5) up to t1, in units of the approach.
    """
    time, top = np.maximum(path.time, 0.0), 1.0 / path.rate
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
    force = path.rate**1.5 * response(time, last)
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
        inside = np.maximum(path.depth, 0.0)
        return inside**1.5 + share * path.rate * path.sense * np.sqrt(inside)

    return Truth(force, ("drag",))


def _drift(random: np.random.Generator) -> Truth:
    across = float(random.choice([-1, 1]) * random.uniform(0.01, 0.05))

    def force(path: Path) -> Array:
        return _hertz(path.depth) + across * (path.depth + BEFORE) / (1 + BEFORE)

    return Truth(force, ("baseline_slope",))


def _layer(random: np.random.Generator) -> Truth:
    # Contact radius over thickness at the largest depth.
    chi = 1 / random.uniform(3.0, 10.0)

    def force(path: Path) -> Array:
        inside = np.maximum(path.depth, 0.0)
        x = chi * np.sqrt(inside)
        return inside**1.5 * (1 + 1.133 * x + 1.283 * x**2 + 0.769 * x**3 + 0.0975 * x**4)

    return Truth(force, ("thickness",))


def _ball(random: np.random.Generator) -> Truth:
    deepest = random.uniform(0.2, 0.8)

    def force(path: Path) -> Array:
        curve = _shape("sphere").force_curve(path.depth * deepest * RADIUS, 0.0)
        return curve.force / _scale(deepest)

    return Truth(force, ("sphere",), depth=deepest)


def _pink_noise(random: np.random.Generator) -> Truth:
    return Truth(lambda path: _hertz(path.depth), ("none",), coloured=True)


def _adhesion(tensed: bool) -> Callable[[np.random.Generator], Truth]:
    def truth(random: np.random.Generator) -> Truth:
        share = random.uniform(0.02, 0.1)
        ratio = float(np.exp(random.uniform(np.log(0.03), np.log(1.0)))) if tensed else 0.0
        top = MODULUS_ * _scale(DEPTH)
        indenter: Any = _shape("paraboloid")
        tension = ratio * RADIUS * MODULUS_ / 2
        work = share * top / (1.5 * np.pi * RADIUS)
        theory = Adhesion(indenter, MODULUS_, tension, work)
        end = theory.instability(np.inf)
        radii = np.geomspace(float(end.contact_radius), RADIUS, 3000)
        branch = theory.equilibrium(radii)

        def force(path: Path) -> Array:
            depth = path.depth * DEPTH * RADIUS
            touches = np.where(path.sense < 0, depth > branch.depth[0], depth > 0)
            return np.where(touches, np.interp(depth, branch.depth, branch.force), 0.0) / top

        return Truth(force, ("tension+adhesion" if tensed else "adhesion",), tension=ratio)

    return truth


@cache
def _shape(type_: str) -> HasForceCurve:
    indenter = pl.indenter(type_, radius=RADIUS)
    assert isinstance(indenter, HasForceCurve)
    return indenter


def _pink(random: np.random.Generator, points: int) -> Array:
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
}


class Curve(NamedTuple):
    """Position [m], force [N] and time [s] of a measurement."""

    position: Array
    force: Array
    time: Array


@dataclass
class Sample:
    """A solid, and measurements of it with noise of one size."""

    truth: Truth
    random: np.random.Generator
    noise: float = field(init=False)

    def __post_init__(self) -> None:
        self.noise = self.random.uniform(*NOISE)

    def measured(self, rows: Path) -> Curve:
        """Return a measurement along a path; the approach at the first speed takes 1 s."""
        force = self.truth.force(rows)
        top = float(np.abs(self.truth.force(path())).max())
        size = force.size
        noise = (
            _pink(self.random, size) if self.truth.coloured else self.random.standard_normal(size)
        )
        deepest = self.truth.depth * RADIUS
        scale = MODULUS_ * _scale(self.truth.depth)
        return Curve(
            rows.depth * deepest + 1e-6, scale * (force + self.noise * top * noise), rows.time + 1.0
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
    seconds: float


def verdict_of(fit: Any) -> str:
    """Return the verdict of a fit or a pooled fit."""
    return fit.rivals.verdict if fit.rivals is not None else "not shown"


def outcomes(name: str, curves: int, seed: int, *, follow: bool = True) -> Iterator[Outcome]:
    """Yield what fits say of curves of a kind."""
    for number in range(curves):
        random = np.random.default_rng([seed, number, *name.encode()])
        sample = Sample(KINDS[name](random), random)
        yield outcome(sample, follow=follow)


def outcome(sample: Sample, segment: str = "approach", *, follow: bool = True) -> Outcome:
    """Return what the fit of one curve says."""
    began = process_time()
    curve = sample.measured(path(segment))
    fit = fitted(sample, curve, segment)
    seconds = process_time() - began
    verdict = verdict_of(fit)
    rivals = fit.rivals
    tied = tuple(tie.rival.code for tie in rivals.tied) if rivals is not None else ("none",)
    covers = any(holds(estimate) for estimate in moduli_of(fit))
    named = rivals.advice if rivals is not None else ""
    second = ""
    if follow and verdict == "undecided" and named:
        second = followed(sample, curve, named)
    right = verdict == "not shown" or any(code in tied for code in sample.truth.codes)
    return Outcome(verdict, named, tied, second, right, covers, seconds)


def moduli_of(fit: pl.Fit) -> list[pl.Estimate]:
    """Return the modulus of the fit, or of all explanations that it cannot tell apart."""
    if fit.rivals is None or fit.rivals.verdict == "not shown":
        return [fit.reduced_modulus]
    tied = fit.rivals.tied if fit.rivals.verdict == "undecided" else fit.rivals.fits[:1]
    return [tie.estimates["reduced_modulus"] for tie in tied]


def holds(estimate: pl.Estimate) -> bool:
    """Return whether an interval, or 1.96 bounds if none was sought, holds the true modulus."""
    low, high = estimate.low, estimate.high
    if low is None and high is None:
        error = 1.96 * estimate.bound / estimate.value
        low, high = estimate.value * np.exp(-error), estimate.value * np.exp(error)
    return (low or 0.0) <= MODULUS_ <= (high or np.inf)


def followed(sample: Sample, curve: Curve, named: str) -> str:
    """Return the verdict with the measurement that a fit names."""
    if "retraction" in named:
        return verdict_of(fitted(sample, sample.measured(path("both")), "both"))
    if "dwell" in named:
        return verdict_of(fitted(sample, sample.measured(path(dwell=True)), "both"))
    if "second speed" in named:
        first = sample.truth.depth * RADIUS
        rate = 10.0 if float(named.partition("speed of ")[2].split()[0]) * 1e-6 > first else 0.1
        return verdict_of(pooled(sample, [curve, sample.measured(path(rate=rate))]))
    return "not tried"


def pooled(sample: Sample, curves: list[Curve], **options: Any) -> pl.PooledFit:
    """Return the pooled fit of several approaches."""
    named = {str(number): (curve.position, curve.force) for number, curve in enumerate(curves)}
    speeds = [float((c.position[-1] - c.position[0]) / (c.time[-1] - c.time[0])) for c in curves]
    return pl.fit_pooled(
        named, indenter=sample.truth.indenter, radius=RADIUS, speed=speeds, **options
    )


def main() -> None:
    """Print a row of a table for each kind."""
    given = [int(text) for text in sys.argv[1:3]]
    curves, seed = [*given, *_DEFAULT[len(given) :]]
    names = sys.argv[3:] or list(KINDS)
    print(f"{curves} curves each | approach | with the measurement named | named | right | E* | s")
    print("--- | --- | --- | --- | --- | --- | ---")
    for name in names:
        results = list(outcomes(name, curves, seed))
        columns = [
            Counter(result.verdict for result in results),
            Counter(result.second for result in results if result.second),
            Counter(" ".join(result.named.split()[:4]) for result in results if result.named),
        ]
        cells = [", ".join(f"{n} {key}" for key, n in count.items()) for count in columns]
        right, covers = (
            100 * np.mean([getattr(result, field) for result in results])
            for field in ("right", "covers")
        )
        seconds = np.median([result.seconds for result in results])
        cells += [f"{right:.0f} %", f"{covers:.0f} %", f"{seconds:.2f}"]
        print(f"{name} | {' | '.join(cells)}", flush=True)


if __name__ == "__main__":
    main()
