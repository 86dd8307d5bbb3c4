"""How well parameters explain a curve: residuals, their Jacobian, minima and profiles."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from pellicle.arrays import Array
from pellicle.components import HasForceCurve
from pellicle.components.calls import force_curve_of
from pellicle.errors import ConvergenceError
from pellicle.fitting.models.interpolated import SimulatedCurve

POINT, MODULUS, TENSION, OFFSET, SLOPE = range(5)
"""Parameters: contact point [m], log of E* in Pa, τ₀ [N/m], force offset [N], its slope [N/m]."""
NAMES = ("contact_point", "reduced_modulus", "tension", "offset", "slope")
"""What results call them."""
REACH = np.log(100.0)
"""How far in log E*, and in log τ₀ above, an interval is followed before it is called open."""
FARTHEST = 10.0
"""How far outside the curve contact may have begun, over the range of positions."""
_METHODS: tuple[tuple[Literal["dogbox", "trf"], int], ...] = (("dogbox", 60), ("trf", 1000))
"""Searches for a minimum, and the steps that they may take."""
_TOLERANCE = 1e-10
_ACCURACY = 1e-6
"""Of the master curves."""
_BALANCING = 200
"""Steps of Newton's method in which they must."""
_BALANCED = 1e-9
"""To which cantilever and solid balance, relative to the range of the force."""


class Minimum(NamedTuple):
    """Parameters of least χ²."""

    parameters: Array
    chi_squared: float


def least(found: Iterable[Minimum]) -> Minimum:
    """Return the least of several minima."""
    return min(found, key=lambda each: each.chi_squared)


def best_minimum(
    chi_squared: ChiSquared, starts: Iterable[Array], held: Sequence[int] = ()
) -> Minimum:
    """Return the least of the minima near several starts, of those whose search ends.

    Raises
    ------
    ConvergenceError
        None of them ends.
    """
    minima: list[Minimum] = []
    error: ConvergenceError | None = None
    for start in starts:
        try:
            minima.append(chi_squared.minimise(start, held))
        except ConvergenceError as failure:
            error = failure
    if error is not None and not minima:
        raise error
    return least(minima)


class ChiSquared(ABC):
    """χ² over parameters of which `POINT`, `MODULUS` and `TENSION` come first."""

    free: tuple[int, ...]
    """The parameters that are not held."""

    @cached_property
    @abstractmethod
    def scale(self) -> Array:
        """What each parameter moves by, about."""

    @cached_property
    @abstractmethod
    def limits(self) -> tuple[Array, Array]:
        """The least and the greatest value of each parameter; of the modulus, relative.

        A contact point further away than `FARTHEST`, or a baseline that carries more than the
        whole force, makes other parameters cancel it, along valleys that never end.
        """

    @abstractmethod
    def expanded(self, parameters: Array) -> tuple[Array, Array]:
        """Return residuals over the noise, whose squares add up to χ², and their derivatives.

        The derivatives have a column for each parameter.
        """

    @property
    @abstractmethod
    def accuracy(self) -> float:
        """Of the model, relative to the largest force; less noise than this cannot be told."""

    @abstractmethod
    def coarse(self) -> ChiSquared | None:
        """Return the same with force curves of coarser grids; None where none is simulated."""

    def kind(self, which: int) -> int:
        """Return which parameter of a curve a parameter is."""
        return which

    def residuals(self, parameters: Array) -> Array:
        """Return residuals over the noise; their squares add up to χ²."""
        return self.expanded(parameters)[0]

    def slopes(self, parameters: Array) -> Array:
        """Return the derivatives of the residuals in each parameter, a column for each."""
        return self.expanded(parameters)[1]

    def chi_squared(self, parameters: Array) -> float:
        """Return the sum of squared residuals."""
        residuals = self.residuals(parameters)
        return float(residuals @ residuals)

    def information(self, parameters: Array, free: Sequence[int]) -> Array:
        """Return the Fisher information of some parameters, in units of `scale`."""
        jacobian = self.slopes(parameters)[:, free] * self.scale[list(free)]
        return jacobian.T @ jacobian

    def deviations(self, parameters: Array) -> Array:
        """Return the Cramér–Rao bound of each parameter, as a standard deviation; 0 if held.

        At its limit, 0, the tension has none, and the bounds of the others are those without it:
        an interval that ends there may be narrower than the bound of a tension of either sign.
        """
        if TENSION in self.free and not parameters[TENSION]:
            bound = self.bounds(parameters, [k for k in self.free if k != TENSION])
            bound[TENSION] = np.inf
            return bound
        return self.bounds(parameters, self.free)

    def bounds(self, parameters: Array, free: Sequence[int]) -> Array:
        """Return the Cramér–Rao bound of each free parameter as a standard deviation, 0 else."""
        bound = np.zeros(parameters.size)
        if not free:
            return bound
        information = self.information(parameters, free)
        try:
            variances = np.diag(np.linalg.inv(information))
        except np.linalg.LinAlgError:
            variances = np.full(len(free), np.inf)
        variances = np.where(variances > 0, variances, np.inf)
        bound[list(free)] = np.sqrt(variances) * self.scale[list(free)]
        return bound

    def minimise(self, start: Array, held: Sequence[int] = ()) -> Minimum:
        """Return the least χ² near ``start``, some of the parameters held."""
        free = [k for k in self.free if k not in held]
        best = np.array(start, dtype=float)
        if not free:
            return Minimum(best, self.chi_squared(best))
        scale = self.scale[free]
        lowest, highest = (limit.copy() for limit in self.limits)
        lowest[MODULUS] += start[MODULUS]
        highest[MODULUS] += start[MODULUS]

        def full(u: Array) -> Array:
            parameters = best.copy()
            parameters[free] = u * scale
            return parameters

        # The optimiser asks for slopes where it has just asked for residuals.
        slopes: dict[bytes, Array] = {}

        def residuals(u: Array) -> Array:
            slopes.clear()
            found, slopes[u.tobytes()] = self.expanded(full(u))
            return found

        def jacobian(u: Array) -> Array:
            known = slopes.get(u.tobytes())
            return (self.slopes(full(u)) if known is None else known)[:, free] * scale

        u = np.clip(best[free], lowest[free], highest[free]) / scale
        # Dogbox is the faster where bounds are active, but creeps along curved valleys.
        for method, most in _METHODS:
            solution = least_squares(
                residuals,
                u,
                jacobian,
                (lowest[free] / scale, highest[free] / scale),
                method=method,
                xtol=_TOLERANCE,
                ftol=_TOLERANCE,
                gtol=_TOLERANCE,
                max_nfev=most,
            )
            if solution.success:
                return Minimum(full(solution.x), 2 * float(solution.cost))
            u = solution.x
        raise ConvergenceError(
            f"the search for the parameters of least χ² did not end in {_METHODS[-1][1]} steps: "
            "the curve does not tell them apart; hold one of them (fix), or fit less of the "
            "baseline"
        )


@dataclass(frozen=True)
class Likelihood(ChiSquared):
    """χ² of a curve under normal noise in the force, equal at all points."""

    position: Array
    force: Array
    indenter: HasForceCurve
    noise: float
    free: tuple[int, ...]
    stiffness: float | None = None
    """Of the cantilever [N/m] whose deflection was subtracted to get the position; noise of the
    force is then in the position too, and what is exact is the position of its base."""

    @cached_property
    def scale(self) -> Array:
        """What each parameter moves by, about."""
        span, height = float(np.ptp(self.position)), float(np.ptp(self.force))
        return np.array([span, 1.0, height / span, height, height / span])

    @cached_property
    def base(self) -> Array:
        """Position of the cantilever's base [m], or of the indenter if no stiffness is known.

        This is what the instrument sets, so it holds no noise of the force.
        """
        if self.stiffness is None:
            return self.position
        return self.position + self.force / self.stiffness

    @cached_property
    def travel(self) -> Array:
        """Travel of the base since the first point [m], along which a baseline drifts.

        The position of the tip holds the measured force over the stiffness: with a slope of minus
        the stiffness along it, any curve would be reproduced exactly.
        """
        travel: Array = self.base - self.base[0]
        return travel

    @property
    def accuracy(self) -> float:
        """Of the model, relative to the largest force."""
        curve = self.indenter
        return curve.accuracy if isinstance(curve, SimulatedCurve) else _ACCURACY

    @cached_property
    def limits(self) -> tuple[Array, Array]:
        """The least and the greatest value of each parameter; of the modulus, relative."""
        span, height = float(np.ptp(self.position)), float(np.ptp(self.force))
        steepest = height / float(self.travel[-1])
        # E* moves far beyond every interval, and to where no exponential overflows.
        lowest = [self.position.min() - FARTHEST * span, -20, 0, self.force.min() - height]
        highest = [self.position.max(), 20, np.inf, self.force.max() + height]
        return np.array([*lowest, -steepest]), np.array([*highest, steepest])

    def coarse(self) -> Likelihood | None:
        """Return the same with the force curve of a coarser grid, if it has one."""
        curve = self.indenter
        if not isinstance(curve, SimulatedCurve) or curve.coarse is None:
            return None
        return replace(self, indenter=curve.coarse)

    def model(self, parameters: Array) -> Array:
        """Return the force [N] at every position."""
        return self._model(self.position, parameters)[0]

    def _model(self, position: Array, parameters: Array) -> tuple[Array, Array]:
        point, log_modulus, tension, offset, slope = parameters
        modulus = np.exp(log_modulus)
        length = 2 * tension / modulus
        curve = force_curve_of(self.indenter, position - point, length)
        moved = self.travel
        force = modulus * curve.force + offset + slope * moved
        jacobian = np.column_stack(
            [
                -modulus * curve.by_depth,
                modulus * (curve.force - length * curve.by_length),
                2 * curve.by_length,
                np.ones_like(moved),
                moved,
            ]
        )
        return force, jacobian

    def jacobian(self, parameters: Array) -> Array:
        """Return the derivatives of the force, shape (n, 5)."""
        return self._model(self.position, parameters)[1]

    def expanded(self, parameters: Array) -> tuple[Array, Array]:
        """Return (model − force) / noise and its derivatives, shapes (n,) and (n, 5)."""
        force, jacobian = self._balanced(parameters)
        return (force - self.force) / self.noise, jacobian / self.noise

    def _balanced(self, parameters: Array) -> tuple[Array, Array]:
        """Return force and derivatives where the base of the cantilever is, not its tip.

        There the force F solves F = P(z − F/k). P grows ever faster, so that Newton's steps are
        monotonic after the first.
        """
        if self.stiffness is None:
            return self._model(self.position, parameters)
        force = self.force.copy()
        # Positions that are far from 0 are rounded, and so is the force that they balance.
        rounding = 8 * float(np.finfo(float).eps * np.max(np.abs(self.base))) * self.stiffness
        enough = max(_BALANCED * float(np.ptp(self.force)), rounding)
        for _ in range(_BALANCING):
            there, jacobian = self._model(self.base - force / self.stiffness, parameters)
            give = 1 - jacobian[:, POINT] / self.stiffness
            step = (there - force) / give
            force += step
            # Written so that NaN ends it.
            if not np.max(np.abs(step)) > enough:
                return force, jacobian / give[:, None]
        raise ConvergenceError(
            f"the force of the cantilever does not balance that of the solid in {_BALANCING} "
            "steps; is the spring constant right?"
        )
