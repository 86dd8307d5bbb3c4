"""Likelihood of one measured curve: residuals and their Jacobian."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.errors import ConvergenceError
from pellicle_fit.files.measurement import Segment
from pellicle_fit.long_memory import differenced
from pellicle_fit.models.force_model import ForceModel, HasRows, ModelForce
from pellicle_fit.models.history import History, constant_speed, last_row_of_loading
from pellicle_fit.parameters import CONTACT_POINT, OFFSET, SLOPE, Coordinates, Parameter

from .chi_squared import ChiSquared, Range
from .condensed import Condensation, Rows

_Value = TypeVar("_Value")

_FARTHEST = 10.0
"""Largest distance of the contact point before the first position, over the range of positions."""
_LENGTHS = (0.05, 1e6)
"""Least and largest length (thickness of a layer) over the range of positions."""
_LARGEST_CHANGE = 20.0
"""Largest change of a logarithm in one search: beyond every interval, and exp does not overflow."""
_NODES = 32
"""Half the number of nodes that a condensation tries first."""
_SLOWEST = np.log(30.0)
"""Logarithm of the ratio of a relaxation time, either way, to the one that a search starts from."""
_BALANCE_STEPS = 200
"""Largest number of Newton steps for the balance of cantilever and solid."""
_BALANCE_TOLERANCE = 1e-9
"""Last Newton step of that balance, relative to the range of the force."""


@dataclass(frozen=True)
class Likelihood(ChiSquared):
    """χ² of one curve under normal noise of the force, independent and equal at all points."""

    position: Array
    """[m], of shape (n,), increasing into the solid."""
    force: Array
    """[N], of shape (n,)."""
    force_model: ForceModel
    noise: float
    """Standard deviation of the force [N]."""
    free: tuple[Parameter, ...]
    stiffness: float | None = None
    """Spring constant [N/m] of the cantilever whose deflection was subtracted to get the position.
    Noise of the force is then in the position too; only the position of the base is exact."""
    time: Array | None = None
    """Time of each row [s], of shape (n,); None if it is not known."""
    segment: Segment = "approach"
    """Pass that was measured; rows of one are sorted by position, those of both by time."""
    condensation: Condensation | None = None
    """Sum of squares over more rows; those here are its nodes."""
    memory: float = 0.0
    """Exponent d of noise whose power falls as f^(−2d); ``noise`` is that of the differences which
    make it independent."""
    duration: float = 1.0
    """Time of an approach [s] where that of the rows is not known."""

    @cached_property
    def history(self) -> History:
        """Path in time, at constant speed if the time is not known."""
        time = self.time
        if time is None and self.segment == "both":
            time = self.duration * constant_speed(self.base)
        elif time is None:
            share = (self.base - self.base[0]) / np.ptp(self.base)
            time = self.duration * (share if self.segment == "approach" else 1 - share)
        return History.of(self.position, time)

    @cached_property
    def first_pass(self) -> Mask:
        """Whether a row is taken on the first pass, dwell included, of shape (n,)."""
        if self.segment != "both":
            return np.full(self.position.size, True)
        rows = np.arange(self.position.size)
        return np.asarray(rows <= last_row_of_loading(self.base))

    @cached_property
    def moves_out(self) -> Mask:
        """Whether a row is taken while the indenter moves out of the solid, of shape (n,)."""
        return self.first_pass if self.segment == "retract" else ~self.first_pass

    def thinned(self, points: int) -> Likelihood:
        """Return about as many rows as ``points``, with the noise of as much information."""
        step = max(self.force.size // points, 1)
        rows = slice(None, None, step)
        return replace(
            self,
            position=self.position[rows],
            force=self.force[rows],
            noise=self.noise_of(step),
            time=None if self.time is None else self.time[rows],
        )

    def noise_of(self, step: float) -> float:
        """Return the noise [N] of rows ``step`` times as far apart with as much information."""
        return self.noise * float(step ** (self.memory - 0.5))

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Contact point, those of the force model, offset and slope of the baseline."""
        return (CONTACT_POINT, *self.force_model.parameters, OFFSET, SLOPE)

    @cached_property
    def base(self) -> Array:
        """Position of the cantilever's base [m], or of the indenter without a stiffness.

        The instrument sets it, so it does not contain noise of the force.
        """
        if self.stiffness is None:
            return self.position
        return self.position + self.force / self.stiffness

    @cached_property
    def travel(self) -> Array:
        """Travel of the base since the first point [m], along which a baseline drifts.

        The position of the tip contains the measured force over the stiffness: a baseline along it
        with a slope of minus the stiffness would reproduce any curve exactly.
        """
        travel: Array = self.base - self.base[0]
        return travel

    @property
    def accuracy(self) -> float:
        """Error of the model relative to the largest force."""
        return self.force_model.accuracy

    @property
    def is_sudden(self) -> bool:
        """Whether χ² jumps as a row touches."""
        return bool(getattr(self.force_model, "is_sudden", False))

    @cached_property
    def ranges(self) -> Mapping[Parameter, Range]:
        """Scale and limits of each coordinate; the scale of a force model's follows its unit."""
        z, force = self.position, self.force
        span, height = float(np.ptp(z)), float(np.ptp(force))
        duration = 1.0 if self.time is None else float(np.ptp(self.time))
        sizes = {
            "m": span,
            "N": height,
            "N/m": height / span,
            "J/m^2": height / span,
            "N/s": height / duration,
            "Pa s": height * duration / span**2,
            "": 1.0,
        }
        steepest = height / float(np.ptp(self.travel))

        def range_of(parameter: Parameter) -> Range:
            if parameter.is_length:
                return Range(1.0, *(float(np.log(share * span)) for share in _LENGTHS))
            if parameter.logarithmic:
                largest = _SLOWEST if parameter.unit == "s" else _LARGEST_CHANGE
                return Range(1.0, -largest, largest)
            return Range(sizes[parameter.unit], parameter.minimum, parameter.maximum)

        farthest = z.min() - _FARTHEST * span
        low, high = getattr(self.force_model, "touches_between", None) or (farthest, z.max())
        return {p: range_of(p) for p in self.force_model.parameters} | {
            CONTACT_POINT: Range(span, low, high),
            OFFSET: Range(height, force.min() - height, force.max() + height),
            SLOPE: Range(height / span, -steepest, steepest),
        }

    @property
    def members(self) -> tuple[Likelihood, ...]:
        """The curve itself."""
        return (self,)

    def with_members(self, members: Sequence[Likelihood]) -> Likelihood:
        """Return the one of ``members``."""
        (member,) = members
        return member

    def curves(self, parameters: Coordinates) -> list[tuple[Likelihood, Coordinates]]:
        """Return the likelihood and the coordinates of the one curve."""
        return [(self, parameters)]

    def joined(self, parts: Sequence[Mapping[Parameter, _Value]]) -> dict[Parameter, _Value]:
        """Return the values of the one curve."""
        (part,) = parts
        return dict(part)

    def condensed(self, parameters: Coordinates, tolerance: float) -> Likelihood:
        """Return the same χ² from a model that is evaluated at fewer rows, if it is that smooth."""
        if self.memory or self.is_sudden:
            return self
        force, _ = self._balanced(parameters)
        groups, count = self._smooth(parameters[CONTACT_POINT]), _NODES
        while 4 * count <= self.force.size:
            condensation = Condensation.of(groups, self.force, count)
            if condensation.error(force) <= tolerance * self.noise:
                rows, model = condensation.nodes, self.force_model
                return replace(
                    self,
                    position=self.position[rows],
                    force=self.force[rows],
                    time=None if self.time is None else self.time[rows],
                    force_model=model.at_rows(rows) if isinstance(model, HasRows) else model,
                    condensation=condensation,
                )
            count *= 2
        return self

    def _smooth(self, point: float) -> list[tuple[Rows, Array, float | None]]:
        """Return rows of loading, dwell and unloading, a coordinate, and where models bend."""
        size, time = self.force.size, self.history.time
        kind = np.zeros(size)
        if self.segment == "both":
            kind = np.where(self.first_pass, np.where(time < self.history.top, 0.0, 1.0), 2.0)
        groups: list[tuple[Rows, Array, float | None]] = []
        for value in np.unique(kind):
            rows = np.flatnonzero(kind == value)
            dwells = value == 1
            groups.append((rows, (time if dwells else self.base)[rows], None if dwells else point))
        return groups

    def depth(self, parameters: Coordinates) -> Array:
        """Return the position relative to the contact point [m]."""
        depth: Array = self.position - parameters[CONTACT_POINT]
        return depth

    def deepest(self, parameters: Coordinates) -> float:
        """Return the largest position relative to the contact point [m]."""
        return float(self.position.max()) - parameters[CONTACT_POINT]

    def model(self, parameters: Coordinates) -> Array:
        """Return the force [N] at every position."""
        if self.force_model.on_base:
            return self._balanced(parameters)[0]
        return self._elastic(self.position, parameters).force + self._baseline(parameters)

    def _elastic(self, position: Array, parameters: Coordinates) -> ModelForce:
        """Return the force of the model without the baseline."""
        model, point = self.force_model, parameters[CONTACT_POINT]
        values = {p: p.value(parameters[p]) for p in model.parameters}
        return model.force(position - point, {**values, CONTACT_POINT: point})

    def _baseline(self, parameters: Coordinates) -> Array:
        return parameters[OFFSET] + parameters[SLOPE] * self.travel

    def _by_coordinate(self, elastic: ModelForce, parameters: Coordinates) -> Array:
        """Return the Jacobian of the force by coordinate, of shape (n, number of parameters)."""
        by_point = elastic.by_parameter.get(CONTACT_POINT, 0.0) - elastic.by_depth
        columns = [
            elastic.by_parameter[p] * (p.value(parameters[p]) if p.logarithmic else 1.0)
            for p in self.force_model.parameters
        ]
        return np.column_stack([by_point, *columns, np.ones_like(self.travel), self.travel])

    def fitted(self, parameters: Coordinates) -> tuple[Array, Array]:
        """Return position [m] and force [N] of the model, both without noise.

        A cantilever puts the noise of the measured force into the measured position.
        """
        force, _ = self._balanced(parameters)
        return self.base - force / self.stiffness if self.stiffness else self.position, force

    def misfit(self, parameters: Coordinates) -> Array:
        """Return model − force [N], of shape (n,), as measured."""
        return self._balanced(parameters)[0] - self.force

    def resampled(self, points: int) -> Likelihood:
        """Return the same with positions of the base and forces interpolated between the rows."""
        row = np.arange(self.force.size)
        between = np.linspace(0, row[-1], points)
        base, force = (np.interp(between, row, values) for values in (self.base, self.force))
        position = base - force / self.stiffness if self.stiffness else base
        return replace(self, position=position, force=force)

    def linearised(self, parameters: Coordinates) -> tuple[Array, Array]:
        """Return (model − force)/noise, of shape (n,), and its Jacobian.

        Of noise with a memory, its fractional differences.
        """
        force, jacobian = self._balanced(parameters)
        if self.memory:
            jacobian = differenced(jacobian, self.memory)
            return differenced(force - self.force, self.memory) / self.noise, jacobian / self.noise
        if self.condensation is None:
            return (force - self.force) / self.noise, jacobian / self.noise
        residuals, jacobian = self.condensation.residuals(force, jacobian)
        return residuals / self.noise, jacobian / self.noise

    def _balanced(self, parameters: Coordinates) -> tuple[Array, Array]:
        """Return force and Jacobian at the exact position of the base rather than the noisy tip.

        There the force solves F = P(z − F/k). P is convex in the depth, so Newton's iteration is
        monotonic after its first step.
        """
        baseline = self._baseline(parameters)
        if self.stiffness is None or self.force_model.on_base:
            elastic = self._elastic(self.base, parameters)
            return elastic.force + baseline, self._by_coordinate(elastic, parameters)
        force = self.force.copy()
        # Positions far from 0 are rounded, and so is the force that balances them.
        rounding = 8 * float(np.finfo(float).eps * np.max(np.abs(self.base))) * self.stiffness
        tolerance = max(_BALANCE_TOLERANCE * float(np.ptp(self.force)), rounding)
        for _ in range(_BALANCE_STEPS):
            elastic = self._elastic(self.base - force / self.stiffness, parameters)
            give = 1 + elastic.by_depth / self.stiffness
            step = (elastic.force + baseline - force) / give
            force += step
            # Negated so that NaN ends the iteration.
            if not np.max(np.abs(step)) > tolerance:
                return force, self._by_coordinate(elastic, parameters) / give[:, None]
        raise ConvergenceError(
            f"the force of the cantilever does not balance that of the solid in {_BALANCE_STEPS} "
            "steps; is the spring constant right?"
        )
