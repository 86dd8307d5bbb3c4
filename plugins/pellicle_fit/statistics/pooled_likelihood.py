"""Likelihood of several curves that share some parameters, and the search for its minima."""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np
from scipy.special import chdtrc

from pellicle.arrays import Array
from pellicle.units import decimal
from pellicle_fit.parameters import Coordinates, Parameter

from .chi_squared import ChiSquared, Minimum, Range, least
from .initial_guess import GUESSES
from .likelihood import Likelihood

_Value = TypeVar("_Value")
_CHANCE = 1e-3
"""Probability below which a disagreement is not attributed to chance."""


class Excess(NamedTuple):
    """Rise of χ² if curves share parameters, over that of each curve on its own."""

    chi_squared: float
    degrees: int

    @classmethod
    def of(cls, pool: ChiSquared, chi_squared: float, alone: Sequence[float]) -> Excess:
        """Return that of a pool at its minimum, from the least χ² of each curve on its own."""
        shared = [p for p in pool.free if p.shared]
        return cls(max(chi_squared - sum(alone), 0.0), len(shared) * (len(alone) - 1))

    @property
    def factor(self) -> float:
        """The factor by which it widens χ² of a rise, 1 if it is within chance."""
        if chdtrc(self.degrees, self.chi_squared) >= _CHANCE:
            return 1.0
        return max(self.chi_squared / self.degrees, 1.0)

    def agreement(self, worst: str = "") -> str:
        """Return in words whether the curves agree, and by how much the intervals are widened.

        ``worst`` is the name of the curve that agrees least.
        """
        figures = (
            f"(Δχ² = {decimal(self.chi_squared, 3)} for {self.degrees} degrees of freedom against "
            "each on its own)"
        )
        if self.factor == 1:
            return f"the curves agree {figures}"
        least = f", {worst} least of all" if worst else ""
        return (
            f"the curves do not agree on the shared parameters {figures}{least}; the intervals are "
            f"widened by {decimal(np.sqrt(self.factor), 2)}"
        )


@dataclass(frozen=True)
class Pool(ChiSquared):
    """χ² of several curves that share some parameters.

    Each curve has its own values of the others: contact point, offset, slope.
    """

    _members: tuple[Likelihood, ...]
    free: tuple[Parameter, ...]

    @classmethod
    def of(cls, members: Sequence[Likelihood]) -> Pool:
        """Return the pool in which the free parameters of each curve are free."""
        free = (p.of_curve(index) for index, member in enumerate(members) for p in member.free)
        return cls(tuple(members), tuple(dict.fromkeys(free)))

    @property
    def members(self) -> tuple[Likelihood, ...]:
        """The likelihood of each curve."""
        return self._members

    def with_members(self, members: Sequence[Likelihood]) -> Pool:
        """Return the pool of other likelihoods, whose free parameters are free."""
        return Pool.of(members)

    @cached_property
    def _own(self) -> list[dict[Parameter, Parameter]]:
        """For each curve, the parameters of the pool by those of the curve."""
        return [
            {p: p.of_curve(index) for p in member.parameters}
            for index, member in enumerate(self.members)
        ]

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters of the first curve, then those of the others that are not shared."""
        return tuple(dict.fromkeys(p for own in self._own for p in own.values()))

    def curves(self, parameters: Coordinates) -> list[tuple[Likelihood, Coordinates]]:
        """Return likelihood and coordinates of each curve."""
        return list(zip(self.members, self.parts(parameters), strict=True))

    @property
    def shared(self) -> list[Parameter]:
        """The parameters that all curves have in common."""
        return [p for p in self.parameters if p.shared]

    def parts(self, parameters: Coordinates) -> list[Coordinates]:
        """Return the coordinates of each curve."""
        return [{p: parameters[q] for p, q in own.items()} for own in self._own]

    def joined(self, parts: Sequence[Mapping[Parameter, _Value]]) -> dict[Parameter, _Value]:
        """Return the parts by parameters of the pool, with the first curve's shared ones."""
        pairs = zip(reversed(self._own), reversed(parts), strict=True)
        return {q: part[p] for own, part in pairs for p, q in own.items()}

    @cached_property
    def ranges(self) -> Mapping[Parameter, Range]:
        """Scale and limits of each coordinate; those of the first curve for shared ones."""
        return self.joined([member.ranges for member in self.members])

    @property
    def accuracy(self) -> float:
        """Largest error of a force model relative to the largest force."""
        return max(member.accuracy for member in self.members)

    @property
    def is_sudden(self) -> bool:
        """Whether χ² of a curve jumps as a row touches."""
        return any(member.is_sudden for member in self.members)

    def condensed(self, parameters: Coordinates, tolerance: float) -> Pool:
        """Return the same χ² from models that are evaluated at fewer rows, if they are smooth."""
        members = [m.condensed(part, tolerance) for m, part in self.curves(parameters)]
        return self if all(map(operator.is_, members, self.members)) else self.with_members(members)

    def linearised(self, parameters: Coordinates) -> tuple[Array, Array]:
        """Return a QR-compressed residual vector, six entries per curve, and its Jacobian.

        An orthogonal transformation leaves χ² and the Gauss–Newton step unchanged.  That of the QR
        decomposition of (Jacobian, residuals) reduces each curve to as many rows as there are
        columns, so that a hundred curves fit into memory.
        """
        triangles = []
        for member, part in self.curves(parameters):
            residuals, jacobian = member.linearised(part)
            matrix = np.column_stack([jacobian, residuals])
            triangles.append(np.asarray(np.linalg.qr(matrix, mode="r")))
        jacobian = np.zeros((sum(map(len, triangles)), len(self.parameters)))
        first = 0
        for triangle, own in zip(triangles, self._own, strict=True):
            rows = slice(first, first := first + len(triangle))
            jacobian[rows, self.columns(own.values())] = triangle[:, :-1]
        return np.concatenate([triangle[:, -1] for triangle in triangles]), jacobian

    def initial_minimum(self, single: Sequence[Coordinates]) -> Minimum:
        """Return the minimum of χ² near the best coordinates of the single curves.

        Shared parameters start from the curves with the smallest bound of the first of them, and
        from the median.
        """
        bounds = [m.deviations(part) for m, part in zip(self.members, single, strict=True)]
        informative = sorted(range(len(single)), key=lambda n: bounds[n][self.shared[0]])
        tries = [{p: single[n][p] for p in self.shared} for n in informative[:GUESSES]]
        return least(self._minimise(single, shared) for shared in (*tries, self._median(single)))

    def least_without(self, parameter: Parameter, best: Minimum) -> Minimum:
        """Return the minimum of χ² with a parameter at its least value, from several starts.

        They are ``best`` and the minima of the single curves.
        """
        start, fixed = best.parameters | {parameter: parameter.minimum}, (parameter,)
        single = [m.minimise(part, fixed).parameters for m, part in self.curves(start)]
        return least(
            [self.minimise(start, fixed), self._minimise(single, self._median(single), fixed)]
        )

    def _median(self, parts: Sequence[Coordinates]) -> Coordinates:
        return {p: float(np.median([part[p] for part in parts])) for p in self.shared}

    def _minimise(
        self, parts: Sequence[Coordinates], shared: Coordinates, fixed: Sequence[Parameter] = ()
    ) -> Minimum:
        """Return the minimum near coordinates of each curve, the shared ones replaced."""
        starts = [
            member.minimise(part | shared, self.shared).parameters
            for member, part in zip(self.members, parts, strict=True)
        ]
        return self.minimise(self.joined(starts), fixed)
