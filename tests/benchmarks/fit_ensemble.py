"""How good fits are, over synthetic curves of known truth: error over bound, coverage, claims.

Run it: ``python tests/benchmarks/fit_ensemble.py [curves [seed]]``.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from time import process_time

import numpy as np

import pellicle as pl
from pellicle.components import HasForceCurve
from pellicle_fit.models.force_model import tension_model
from pellicle_fit.parameters import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION
from pellicle_fit.statistics.likelihood import Likelihood

NOISE, DEPTH, BEFORE = 0.005, 0.3, 0.3
"""Noise over the largest force; largest depth over R; range before contact over that in it."""
_DEFAULT = 200, 11
"""Curves and seed."""


@dataclass(frozen=True)
class Score:
    """One curve: errors over the Cramér–Rao bound at the truth, and what the fit said."""

    modulus: float
    tension: float
    covers_modulus: bool
    covers_tension: bool
    claims_tension: bool


def scores(curves: int, seed: int, *, points: int = 2000, tensed: bool = True) -> Iterator[Score]:
    """Yield the score of each of ``curves`` random curves, modulus, radius and s/R log-uniform."""
    random = np.random.default_rng(seed)
    for _ in range(curves):
        modulus = np.exp(random.uniform(np.log(500), np.log(20e3)))
        radius = np.exp(random.uniform(np.log(3e-6), np.log(100e-6)))
        ratio = np.exp(random.uniform(np.log(0.03), np.log(1.0))) if tensed else 0.0
        tension = ratio * radius * modulus / 2
        depth = np.linspace(-BEFORE, 1.0, points) * DEPTH * radius
        indenter = pl.indenter("paraboloid", radius=radius)
        assert isinstance(indenter, HasForceCurve)
        force = modulus * indenter.force_curve(depth, ratio * radius).force
        noise = NOISE * force.max()
        point = random.uniform(-1, 1) * radius
        measured = force + noise * random.standard_normal(points)
        fit = pl.fit(depth + point, measured, indenter=indenter)
        truth = {
            CONTACT_POINT: point,
            MODULUS: float(np.log(modulus)),
            TENSION: tension,
            OFFSET: 0.0,
            SLOPE: 0.0,
        }
        free = (CONTACT_POINT, MODULUS, TENSION)
        true = Likelihood(depth + point, force, tension_model(indenter), noise, free)
        bounds = true.bounds(truth, free)
        yield Score(
            (fit.reduced_modulus.value / modulus - 1) / bounds[MODULUS],
            (fit.tension.value - tension) / bounds[TENSION],
            _covers(fit.reduced_modulus, modulus),
            _covers(fit.tension, tension),
            fit.tension.low is not None,
        )


def _covers(estimate: pl.Estimate, truth: float) -> bool:
    above = estimate.low is None or estimate.low <= truth
    return above and (estimate.high is None or truth <= estimate.high)


def main() -> None:
    """Print the figures."""
    given = [int(text) for text in sys.argv[1:]]
    curves, seed = [*given, *_DEFAULT[len(given) :]]
    for points in (2000, 60):
        for tensed in (True, False):
            began = process_time()
            sample = list(scores(curves, seed, points=points, tensed=tensed))
            modulus, tension = (
                float(np.sqrt(np.mean([getattr(score, name) ** 2 for score in sample])))
                for name in ("modulus", "tension")
            )
            shares = [
                100 * float(np.mean([getattr(score, name) for score in sample]))
                for name in ("covers_modulus", "covers_tension", "claims_tension")
            ]
            print(
                f"{curves} curves of {points} points, {'s/R 0.03-1' if tensed else 'no tension'}: "
                f"rms error over bound {modulus:.2f} (modulus) {tension:.2f} (tension); 95 % "
                f"intervals cover {shares[0]:.1f} % and {shares[1]:.1f} %; tension claimed in "
                f"{shares[2]:.1f} %; {(process_time() - began) / curves:.2f} s a fit"
            )


if __name__ == "__main__":
    main()
