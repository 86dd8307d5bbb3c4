"""An explanation of curves at its least χ², as those that are compared are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import compress

import numpy as np

from pellicle.arrays import Array
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effect import Effect, quantities
from pellicle_fit.explanation import Explanation

from .coordinates import MODULUS
from .intervals import Estimate
from .noise import Flaw, ResidualCheck, check_residuals
from .objective import Objective
from .search import Minimum

Types = frozenset[str]
"""Types of a set of effects."""
NONE: Types = frozenset()


@dataclass(frozen=True, eq=False)
class Candidate:
    """An explanation at its least χ²."""

    types: Types
    """Types of its effects, but for those that all explanations have."""
    objective: Objective
    minimum: Minimum
    all_rows: tuple[Curve, ...]
    """The curves with all their rows."""
    estimates: Mapping[str, Estimate] = field(default_factory=dict)
    """Those whose ends were sought: of the chosen explanation all, unless no model describes."""
    calibration_minimum: tuple[Objective, Minimum] | None = None
    """χ² by which these were sought, and its minimum, where the calibration is weighed."""

    @cached_property
    def aic(self) -> float:
        """Akaike's criterion, less a constant of the curves."""
        return self.objective.criterion(self.chi_squared)

    def beside(self, errors: Sequence[Effect]) -> tuple[Objective, Array]:
        """Return χ² with effects that are weighed as errors of the calibration, and where it is."""
        known = self.objective.explanation
        explanation = replace(known, effects=(*known.effects, *errors))
        objective = replace(self.objective, explanation=explanation)
        at = objective.at_values(self.objective.values(self.minimum.at))
        return objective, np.where(np.isnan(at), 0.0, at)

    @property
    def parameters(self) -> dict[str, Estimate]:
        """All quantities of the explanation by name; some intervals were not sought."""
        values = {}
        for slot, at in zip(self.objective.slots, self.minimum.at, strict=True):
            bare = Estimate(slot.value(at), None, None, slot.quantity.unit)
            values[slot.full_name] = self.estimates.get(slot.full_name, bare)
        for part in self.objective.explanation.parts:
            for name, quantity in quantities(type(part)).items():
                if name not in part.open:
                    value = float(getattr(part, name))
                    values[name] = Estimate(value, value, value, quantity.unit, held=True)
        return values

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Coefficients of correlation of its open quantities, of logarithms of those that are one.

        What is at a limit, or what the curves do not determine at all, has none.
        """
        objective, minimum = self.calibration_minimum or (self.objective, self.minimum)
        free = objective.within(minimum.at)
        jacobian = objective.jacobian(minimum.at, free)
        sizes = np.linalg.norm(jacobian, axis=0)
        unit = jacobian[:, sizes > 0] / sizes[sizes > 0]
        covariance = np.linalg.pinv(unit.T @ unit, rcond=1e-14, hermitian=True)
        deviations = np.sqrt(np.diag(covariance))
        names = [objective.slots[k].full_name for k in compress(free, sizes > 0)]
        return {
            (names[i], names[j]): float(covariance[i, j] / (deviations[i] * deviations[j]))
            for i in range(len(names))
            for j in range(i)
        }

    @property
    def all_estimates(self) -> dict[str, Estimate]:
        """Those of the quantities that were given or whose ends were sought."""
        return {n: e for n, e in self.parameters.items() if e.held or n in self.estimates}

    @property
    def holds_modulus(self) -> bool:
        """Whether E* is that of the solid."""
        return all(effect.holds_modulus for effect in self.objective.explanation.effects)

    @cached_property
    def known(self) -> list[Explanation]:
        """The explanation of each curve, with the values of its quantities."""
        return [self.objective.known(self.minimum.at, i) for i in range(len(self.all_rows))]

    @property
    def contact_points(self) -> list[float]:
        """Position of the base at first touch on each curve [m]."""
        pairs = zip(self.known, self.all_rows, strict=True)
        return [float((curve.base - known.base_depth(curve))[0]) for known, curve in pairs]

    @property
    def depths(self) -> list[Array]:
        """Depth of the tip [m] in each row of each curve, negative before contact."""
        return [known.depth(curve) for known, curve in zip(self.known, self.all_rows, strict=True)]

    @cached_property
    def of_rows(self) -> Objective:
        """χ² of all rows as a function of its quantities."""
        return replace(self.objective, curves=self.all_rows)

    @cached_property
    def squares(self) -> tuple[float, ...]:
        """χ² of all rows of each curve, then that of each term of what is weighed."""
        if all(a is b for a, b in zip(self.all_rows, self.objective.curves, strict=True)):
            return self.minimum.squares
        return self.of_rows.squares(self.of_rows.terms(self.minimum.at))

    @property
    def chi_squared(self) -> float:
        """χ² of all rows."""
        return sum(self.squares)

    @property
    def without_memory(self) -> Candidate:
        """The same with noise that counts as white."""
        return replace(self, objective=replace(self.objective, memory=()))

    def chi_squared_of(self, widened: Sequence[float]) -> float:
        """Return χ² of all rows at noise that was widened by a factor in each curve, as it was."""
        return sum(_scaled(self.squares, widened))

    def forces(self) -> list[Array]:
        """Return the force [N] at all rows of each curve."""
        return self.of_rows.forces(self.minimum.at)

    def relaxed_for(self, time: float) -> Candidate:
        """Return the same with the modulus after another time of loading [s]."""
        old, at, k = self.objective, self.minimum.at.copy(), self.objective.index(MODULUS)
        if k is not None:
            known = self.known[0]
            at[k] += np.log(known.relaxed(time) / known.relaxed(old.loading_time))
        objective, minimum = replace(old, loading_time=time), self.minimum._replace(at=at)
        return replace(self, objective=objective, minimum=minimum)

    def at_noise(self, noise: Sequence[float]) -> Candidate:
        """Return the same at another noise [N] of each curve, which scales χ² and no more."""
        was = self.objective.noise
        factors = [old / new for old, new in zip(was, noise, strict=True)]
        minimum = self.minimum._replace(squares=_scaled(self.minimum.squares, factors))
        objective = replace(self.objective, noise=tuple(noise))
        new = replace(self, objective=objective, minimum=minimum)
        new.__dict__["squares"] = _scaled(self.squares, factors)
        return new

    def polish(self) -> Candidate:
        """Return the same at its least χ² to all digits."""
        return replace(self, minimum=self.objective.minimise(self.minimum.at))

    @cached_property
    def judgements(self) -> list[ResidualCheck]:
        """Noise and flaws of each curve under it, from all rows."""
        at, forces = self.minimum.at, self.forces()
        objective = replace(self.of_rows, memory=())
        jacobian = objective.jacobian(at, objective.within(at))
        # Behind the rows of all curves stand those of what is weighed.
        by_curve = np.split(jacobian, np.cumsum([force.size for force in forces]))[:-1]
        memory = self.objective.memory or [0.0] * len(forces)
        columns, checks = (self.known, self.all_rows, forces, objective.noise, by_curve, memory), []
        for known, curve, force, noise, derivatives, d in zip(*columns, strict=True):
            depth = known.base_depth(curve)
            check = check_residuals(curve, curve.force - force, derivatives * noise, depth, d)
            if np.max(known.depth(curve)) > known.contact(curve).depth_limit:
                check = check._replace(flaws=check.flaws | {Flaw.TOO_DEEP})
            checks.append(check)
        return checks


def _scaled(squares: Sequence[float], factors: Sequence[float]) -> tuple[float, ...]:
    """Return χ² of each curve at noise over a factor, then what is weighed as it is."""
    all_factors = [*factors, *[1.0] * (len(squares) - len(factors))]
    return tuple(f**2 * square for f, square in zip(all_factors, squares, strict=True))


def best_of(candidates: Iterable[Candidate]) -> Candidate:
    """Return the candidate of least AIC."""
    return min(candidates, key=lambda candidate: candidate.aic)
