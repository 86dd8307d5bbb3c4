"""χ² of measured forces as a function of parameters: minima, bounds and Fisher information."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeVar

import numpy as np
from scipy.optimize import least_squares

from pellicle.arrays import Array
from pellicle.errors import ConvergenceError
from pellicle_fit.models.force_model import ForceModel
from pellicle_fit.parameters import Coordinates, Parameter

if TYPE_CHECKING:
    from .likelihood import Likelihood

_Value = TypeVar("_Value")

_METHODS: tuple[tuple[Literal["dogbox", "trf"], int], ...] = (("dogbox", 60), ("trf", 1000))
"""Optimisers, tried in this order, and their largest numbers of steps."""
_TOLERANCE = 1e-10
_ROUGH_METHODS: tuple[tuple[Literal["dogbox", "trf"], int], ...] = (("dogbox", 30), ("trf", 60))
_ROUGH_TOLERANCE = 1e-7


class Minimum(NamedTuple):
    """A minimum of χ²."""

    parameters: Coordinates
    chi_squared: float


class Range(NamedTuple):
    """How far a coordinate varies."""

    scale: float
    """Order of magnitude of its variation."""
    low: float
    """Least coordinate; of a logarithm that is not a length, relative to the start of a search."""
    high: float
    """Greatest coordinate, likewise."""


def least(minima: Iterable[Minimum]) -> Minimum:
    """Return the minimum with the smallest χ²."""
    return min(minima, key=lambda minimum: minimum.chi_squared)


def best_minimum(
    chi_squared: ChiSquared, starts: Iterable[Coordinates], fixed: Sequence[Parameter] = ()
) -> Minimum:
    """Return the smallest of the minima near several starts, ignoring searches that fail.

    Raises
    ------
    ConvergenceError
        All searches fail.
    """
    minima: list[Minimum] = []
    error: ConvergenceError | None = None
    for start in starts:
        try:
            minima.append(chi_squared.minimise(start, fixed))
        except ConvergenceError as failure:
            error = failure
    if error is not None and not minima:
        raise error
    return least(minima)


class ChiSquared(ABC):
    """χ² = Σ (model − force)²/noise² as a function of the coordinates of parameters."""

    free: tuple[Parameter, ...]
    """The parameters that are fitted."""

    @cached_property
    @abstractmethod
    def parameters(self) -> tuple[Parameter, ...]:
        """All parameters, fitted or fixed, in the order of the columns of the Jacobian."""

    @cached_property
    @abstractmethod
    def ranges(self) -> Mapping[Parameter, Range]:
        """Scale and limits of each coordinate.

        Beyond the limits (a contact far before the first position, a baseline that carries more
        than the whole force) other parameters cancel the change, along valleys of χ² without end.
        """

    @abstractmethod
    def linearised(self, parameters: Coordinates) -> tuple[Array, Array]:
        """Return residuals, whose sum of squares is χ², and their Jacobian.

        The Jacobian has a column for each of `parameters`.
        """

    @property
    @abstractmethod
    def accuracy(self) -> float:
        """Error of the model relative to the largest force; noise below it cannot be resolved."""

    @property
    def is_sudden(self) -> bool:
        """Whether χ² jumps as a row touches, where searches to the last digit do not end."""
        return False

    @property
    @abstractmethod
    def members(self) -> tuple[Likelihood, ...]:
        """The likelihood of each curve."""

    @abstractmethod
    def with_members(self, members: Sequence[Likelihood]) -> ChiSquared:
        """Return χ² of other likelihoods, one for each curve, whose free parameters are free."""

    @abstractmethod
    def curves(self, parameters: Coordinates) -> list[tuple[Likelihood, Coordinates]]:
        """Return the likelihood and the coordinates of each curve."""

    @abstractmethod
    def joined(self, parts: Sequence[Mapping[Parameter, _Value]]) -> dict[Parameter, _Value]:
        """Return values by parameter from those of each curve, shared ones from the first."""

    def with_models(self, models: Sequence[ForceModel]) -> ChiSquared:
        """Return the same with other force models, one for each curve."""
        pairs = zip(self.members, models, strict=True)
        return self.with_members([replace(member, force_model=model) for member, model in pairs])

    def coarse(self) -> ChiSquared | None:
        """Return the same with force curves from coarser grids; None if none is simulated."""
        models = [member.force_model for member in self.members]
        if not any(model.coarse for model in models):
            return None
        return self.with_models([model.coarse or model for model in models])

    def condensed(self, parameters: Coordinates, tolerance: float) -> ChiSquared:
        """Return the same χ² from a model that is evaluated at fewer rows, if it is that smooth.

        At ``parameters`` the change of the model is at most ``tolerance`` in the unit of χ, which
        moves no estimate by more than that many standard errors.
        """
        return self

    @cached_property
    def _column(self) -> dict[Parameter, int]:
        return {parameter: column for column, parameter in enumerate(self.parameters)}

    def columns(self, parameters: Iterable[Parameter]) -> list[int]:
        """Return the columns of the Jacobian that belong to some parameters."""
        return [self._column[parameter] for parameter in parameters]

    def residuals(self, parameters: Coordinates) -> Array:
        """Return (model − force)/noise; the sum of squares is χ²."""
        return self.linearised(parameters)[0]

    def jacobian(self, parameters: Coordinates) -> Array:
        """Return the derivatives of the residuals, with a column for each parameter."""
        return self.linearised(parameters)[1]

    def chi_squared(self, parameters: Coordinates) -> float:
        """Return the sum of squared residuals."""
        residuals = self.residuals(parameters)
        return float(residuals @ residuals)

    def deviations(self, parameters: Coordinates) -> Coordinates:
        """Return the Cramér–Rao bound of each coordinate as a standard deviation; 0 if fixed.

        It is infinite for a parameter at its minimum (no tension); the bounds of the others then
        hold with that parameter fixed, because their intervals may be narrower than the bounds that
        would hold if the parameter could also fall below its minimum.
        """
        edge = [p for p in self.free if parameters[p] == p.minimum]
        bounds = self.bounds(parameters, [p for p in self.free if p not in edge])
        return bounds | dict.fromkeys(edge, np.inf)

    def bounds(self, parameters: Coordinates, free: Sequence[Parameter]) -> Coordinates:
        """Return the Cramér–Rao bound of the ``free`` coordinates as standard deviations, else 0.

        It is the root of the diagonal of the inverse Fisher information JᵀJ (Rao 1945).
        """
        bounds = dict.fromkeys(self.parameters, 0.0)
        if not free:
            return bounds
        scale = np.array([self.ranges[p].scale for p in free])
        jacobian = self.jacobian(parameters)[:, self.columns(free)] * scale
        information = jacobian.T @ jacobian
        try:
            variances = np.diag(np.linalg.inv(information))
        except np.linalg.LinAlgError:
            variances = np.full(len(free), np.inf)
        variances = np.where(variances > 0, variances, np.inf)
        return bounds | dict(zip(free, (np.sqrt(variances) * scale).tolist(), strict=True))

    def without(self, parameter: Parameter, best: Minimum) -> Minimum:
        """Return the minimum of χ² near ``best`` with a parameter at its least value."""
        return self.minimise(best.parameters | {parameter: parameter.minimum}, (parameter,))

    def minimise(
        self, start: Coordinates, fixed: Sequence[Parameter] = (), *, rough: bool = False
    ) -> Minimum:
        """Return the minimum of χ² near ``start``, where the parameters in ``fixed`` stay.

        A ``rough`` search ends sooner, and where it has come to; its χ² is an upper bound.

        Raises
        ------
        ConvergenceError
            No optimiser converges: parameters are not identifiable.
        """
        free = [p for p in self.free if p not in fixed]
        if not free:
            return Minimum(start, self.chi_squared(start))
        columns = self.columns(free)
        scale, lowest, highest = np.array([self.ranges[p] for p in free]).T
        origin = np.array([start[p] if p.logarithmic and not p.is_length else 0.0 for p in free])
        lowest, highest = lowest + origin, highest + origin

        def full(u: Array) -> Coordinates:
            return start | dict(zip(free, (u * scale).tolist(), strict=True))

        # The optimiser asks for the Jacobian where it has just asked for the residuals.
        @lru_cache(maxsize=1)
        def linearised(u: bytes) -> tuple[Array, Array]:
            residuals, jacobian = self.linearised(full(np.frombuffer(u)))
            return residuals, jacobian[:, columns] * scale

        u = np.clip([start[p] for p in free], lowest, highest) / scale
        # Dogbox is faster at active bounds, but makes small steps along curved valleys.
        tolerance = _ROUGH_TOLERANCE if rough else _TOLERANCE
        for method, most in _ROUGH_METHODS if rough else _METHODS:
            solution = least_squares(
                lambda u: linearised(u.tobytes())[0],
                u,
                lambda u: linearised(u.tobytes())[1],
                (lowest / scale, highest / scale),
                method=method,
                xtol=tolerance,
                ftol=tolerance,
                gtol=tolerance,
                max_nfev=most,
            )
            if solution.success:
                return Minimum(full(solution.x), 2 * float(solution.cost))
            u = solution.x
        if rough:
            return Minimum(full(u), 2 * float(solution.cost))
        raise ConvergenceError(
            f"the search for the parameters of least χ² did not converge in {_METHODS[-1][1]} "
            "steps: the curve does not tell them apart; fix one of them, or fit less of the "
            "baseline"
        )
