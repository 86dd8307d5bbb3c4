"""How often a fit can tell a weak tension from the adhesion that resembles it most.

The force of a tensed solid, without noise, is fitted by each model without tension; Δχ² of the
best is what the curves hold.  Noise is added in linear form to both fits.  No test between two
hypotheses has greater power than their likelihood ratio (Neyman & Pearson 1933).
Run it: ``python tests/benchmarks/fit_limit.py [draws [seed]] [--figure FILE]``.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import fit_rivals
import numpy as np
from fit_rivals import DEPTH, MODULUS_, RADIUS, Array, path
from matplotlib.figure import Figure
from scipy.special import ndtr, ndtri
from tables import print_head, print_row

from pellicle.show import save_figure
from pellicle_fit.models.force_model import tension_model
from pellicle_fit.parameters import (
    CONTACT_POINT,
    MODULUS,
    OFFSET,
    SLOPE,
    TENSION,
    Coordinates,
)
from pellicle_fit.statistics.chi_squared import ChiSquared
from pellicle_fit.statistics.likelihood import Likelihood
from pellicle_fit.statistics.rivals import MARGIN, rivals

NOISES = 0.003, 0.0055, 0.01
ERRORS = 3.0, 5.0, 5.0 * np.sqrt(2), 9.0
"""Tensions, in standard errors of all rows.  The third is 5 of one approach."""
MARGINS = 3.0, 4.0, 5.0, 6.0
"""Differences of AIC at which claims are counted."""
CONTACT = 1e-6
FALSE = 0.03
"""Share of false claims that is allowed."""


class Case(NamedTuple):
    """A tension and the model without tension that resembles it most."""

    protocol: str
    noise: float
    errors: float
    rival: str
    work: float
    """Its work of adhesion [J/m²]; 0 of another."""
    pull_off: float
    """Its pull-off force over the noise of a row."""
    separation: float
    """Its Δχ² without noise."""
    draws: Array
    """Its Δχ² with noise."""

    def needed(self, margin: float = MARGIN) -> float:
        """Return the share of draws in which the tension is called needed."""
        return float(np.mean(self.draws >= margin))

    def false(self, margin: float) -> float:
        """Return the share of false claims if the rival is right."""
        root = np.sqrt(self.separation)
        return float(ndtr(-(root + margin / root) / 2))

    @property
    def most(self) -> float:
        """Greatest power of a test that claims a tension from the rival in a share `FALSE`."""
        return float(ndtr(np.sqrt(self.separation) + ndtri(FALSE)))


def case(
    protocol: str, noise: float, errors: float, draws: int, random: np.random.Generator
) -> Case:
    """Return the separation of a tension from its rivals, and Δχ² with noise."""
    ratio = errors / 5 * fit_rivals.five_errors(protocol, noise)
    rows = path("both" if protocol == "both" else "approach")
    force = fit_rivals.tensed_at(ratio).force(rows) * MODULUS_ * fit_rivals.hertz_scale(DEPTH)
    deviation = noise * float(force.max())
    # Two speeds of an elastic solid are two equal curves.
    repeated = np.sqrt(2) if protocol == "speeds" else 1.0
    curve = Likelihood(
        rows.depth * DEPTH * RADIUS + CONTACT,
        force,
        tension_model(fit_rivals.shape("paraboloid")),
        deviation / repeated,
        (CONTACT_POINT, MODULUS, TENSION),
        time=rows.time + 1.0,
        segment="both" if protocol == "both" else "approach",
    )
    truth = {
        CONTACT_POINT: CONTACT,
        MODULUS: float(np.log(MODULUS_)),
        TENSION: ratio * RADIUS * MODULUS_ / 2,
        OFFSET: 0.0,
        SLOPE: 0.0,
    }
    fits = []
    for rival in rivals(curve, truth):
        # At two speeds relaxation and drag are told from a tension, unlike in an approach.
        if rival.has_tension or (protocol == "speeds" and rival.code not in ("none", "adhesion")):
            continue
        if pair := rival.minimum(curve, [truth | {TENSION: 0.0}, truth]):
            fits.append(pair)
    rival, best = min(fits, key=lambda pair: pair[1].chi_squared)
    nearest = rival.of(curve)
    left = nearest.residuals(best.parameters)
    spans = [_span(of, at) for of, at in ((nearest, best.parameters), (curve, truth))]
    values = []
    for _ in range(draws):
        white = random.standard_normal(left.size)
        other, own = (
            noisy - span @ (span.T @ noisy)
            for noisy, span in zip((white - left, white), spans, strict=True)
        )
        values.append(float(other @ other - own @ own))
    work = pull_off = 0.0
    if rival.code == "adhesion":
        model: Any = nearest.curves(best.parameters)[0][0].force_model
        known = {p: p.value(best.parameters[p]) for p in model.parameters}
        work, pull_off = known[rival.own[0]], -model.pull_off(known) / deviation
    return Case(
        protocol, noise, errors, rival.code, work, pull_off, best.chi_squared, np.array(values)
    )


def _span(curve: ChiSquared, at: Coordinates) -> Array:
    """Return an orthonormal basis of the changes that a model can make."""
    jacobian = curve.jacobian(at)[:, curve.columns(curve.free)]
    basis: Array = np.linalg.qr(jacobian)[0]
    return basis


def draw(figure: Figure, cases: Sequence[Case]) -> None:
    """Draw the distributions at five standard errors, and the share of claims against errors."""
    left, right = figure.subplots(1, 2)
    for protocol, name in {"both": "both passes", "speeds": "two speeds"}.items():
        own = [c for c in cases if c.protocol == protocol and c.noise == NOISES[1]]
        (five,) = (c for c in own if c.errors == 5)
        *_, (drawn,) = left.hist(five.draws, 40, histtype="step", label=name)
        colour = drawn.get_edgecolor()
        left.axvline(five.separation, color=colour, linestyle=":")
        errors = [c.errors for c in own]
        right.plot(errors, [100 * c.needed() for c in own], "o-", color=colour)
        right.plot(errors, [100 * c.most for c in own], "--", color=colour)
    left.axvline(MARGIN, color="k")
    left.set(xlabel="Δχ² of the nearest adhesion", ylabel="draws")
    left.set_title("tension of 5 standard errors")
    left.legend()
    right.axhline(95, color="0.7")
    right.set(xlabel="tension [standard errors]", ylabel="tension is needed [%]", ylim=(0, 102))
    right.set_title("fit (solid), best possible test (dashed)")


def main() -> None:
    """Print a row of a table for each protocol, noise and tension."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("draws", type=int, nargs="?", default=2000)
    parser.add_argument("seed", type=int, nargs="?", default=7)
    parser.add_argument("--figure", type=Path, help="image of the distributions")
    options = parser.parse_args()
    random = np.random.default_rng(options.seed)
    cases = [
        case(protocol, noise, errors, options.draws, random)
        for protocol in ("both", "speeds")
        for noise in NOISES
        for errors in (ERRORS if noise == NOISES[1] else (5.0,))
    ]
    print_head(
        *("curves", "noise", "standard errors", "nearest", "w [J/m²]", "pull-off/noise", "Δχ²"),
        *("most", *(f"needed (false) at {margin:g}" for margin in MARGINS)),
    )
    for c in cases:
        print_row(
            *(c.protocol, f"{100 * c.noise:.2g} %", f"{c.errors:.2g}", c.rival, f"{c.work:.2g}"),
            *(f"{c.pull_off:.2g}", f"{c.separation:.1f}", f"{100 * c.most:.0f} %"),
            *(f"{100 * c.needed(m):.0f} % ({100 * c.false(m):.1f} %)" for m in MARGINS),
        )
    if options.figure is not None:
        stem, ending = options.figure.with_suffix(""), options.figure.suffix[1:]
        save_figure(lambda figure: draw(figure, cases), stem, [ending], (8.0, 3.4))


if __name__ == "__main__":
    main()
