"""Indenter of revolution that adheres to a tensed solid, held by a cantilever."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, ClassVar, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from pellicle.arrays import Array, Mask
from pellicle.components import HasContactRadius
from pellicle.errors import ConfigError
from pellicle.units import readable
from pellicle_fit.parameters import MODULUS, TENSION, Parameter, Values

from .force_model import ClosedFormModel, ModelForce

WORK_OF_ADHESION = Parameter(
    "work_of_adhesion", "J/m^2", logarithmic=True, shared=True, plausible=(1e-7, 10.0)
)
"""w."""
_SEARCH, _BEYOND, _NODES = 160, 24, 120
"""Nodes of the search for the instability, below and above a depth, and of the branch above it."""
_DECADES = 6.0
"""Range of depths without adhesion that is searched, below the largest."""
_STEP = 1e-4
"""Relative step of numerical derivatives."""
_PENALTY = 30.0
"""Stiffness by which the branch is continued below its end, over that of the whole curve."""
_BARRIER = 300.0
"""The same for rows that the contact has left, where the end of the branch passes them."""
_SIGNIFICANT = 6.0
"""Standard errors that a jump of the force must exceed to decide which rows touch."""
_WIDTH = 3
"""Rows on either side of a jump whose means are compared."""
_LENGTHS = (0.0, 0.1, 1.0)
_WORKS = (3e-5, 3e-4, 3e-3, 3e-2, 0.2)
"""s and w/E* of the initial guesses, over the measured range of positions."""


class _Branch(NamedTuple):
    """Base positions and forces of equilibria, and their derivatives, each of shape (n,)."""

    position: Array
    force: Array
    by_parameter: tuple[tuple[Array, Array], ...]
    """Derivatives of position and force by E*, τ₀ and w, without adhesion the same depth."""


class _Curve(NamedTuple):
    """Interpolated branch, over the root of the base position beyond its end."""

    end: float
    """Base position over the contact point at which the branch ends [m]."""
    end_by: tuple[float, ...]
    """Its derivatives by E*, τ₀ and w."""
    root_limit: float
    """Root of the last position over the end [m^½]."""
    steepness: float
    """Slope of the force below the end [N/m]."""
    spline: CubicSpline
    """Force, and derivatives of position and force by E*, τ₀ and w."""


@dataclass(frozen=True, eq=False)
class AdhesiveModel:
    """Adhesive contact on its stable branch, which a cantilever ends where dF/dδ = −k.

    With force F₁, depth δ₁, stiffness k₁ and radius a of the contact without adhesion the
    equilibria are F = F₁ − k₁D, δ = δ₁ − D, D = √(4πa w / (dk₁/da)): superposition of a punch that
    is retracted by D (Johnson, Kendall & Roberts 1971 without tension).  On approach the indenter
    adheres as it touches, at δ = 0.  Where the curve itself jumps, that decides which rows touch:
    contacts of the real world break early.
    """

    elastic: ClosedFormModel
    moves_out: Mask
    """Whether a row is taken while the indenter moves out, of shape (n,)."""
    attached: Array
    """1 for a row in contact, −1 for one that is not, 0 where the model decides, of shape (n,)."""
    stiffness: float | None = None
    """Spring constant of the cantilever [N/m]; None if it is infinite or not known."""
    ended: Mask | None = None
    """Rows that lie below the end of the branch, of shape (n,); None if a contact may break early,
    as one that jumps does."""
    touches_between: tuple[float, float] | None = None
    """Base positions [m] between which the contact point lies, where the rows of an approach that
    touch are known and no jump of the force tells them; None if it may lie anywhere."""
    reach: float | None = None
    """Base position over the contact point [m] up to which the branch is computed, if it is not
    that of the deepest row: one branch then serves many contact points."""
    parameters: ClassVar[tuple[Parameter, ...]] = (MODULUS, TENSION, WORK_OF_ADHESION)
    coarse: ClassVar[None] = None
    is_sudden: ClassVar[bool] = True
    """The rows at first touch weigh so much that χ² depends on which of them touch."""
    on_base: ClassVar[bool] = True
    accuracy: ClassVar[float] = 1e-5

    def __post_init__(self) -> None:
        if not isinstance(self.elastic.indenter, HasContactRadius):
            raise ConfigError(
                "has no contact radius to adhere with; give a paraboloid, a sphere or a cone",
                "indenter",
            )

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force curve holds."""
        return self.elastic.depth_limit

    @cached_property
    def _radius(self) -> HasContactRadius:
        assert isinstance(self.elastic.indenter, HasContactRadius)
        return self.elastic.indenter

    def force(self, depth: Array, values: Values) -> ModelForce:
        """Return force and derivatives at base positions over the contact point [m]."""
        deepest = float(depth.max()) if self.reach is None else self.reach
        curve = _curve(self, tuple(values[p] for p in self.parameters), deepest)
        beyond = depth - curve.end
        touches = np.where(self.moves_out, beyond >= 0, depth > 0)
        contact = np.where(self.attached == 0, touches, self.attached > 0)
        at = np.sqrt(np.clip(beyond, 0.0, curve.root_limit**2))
        force, *changes = curve.spline(at).T
        rate = curve.spline(at, 1)[:, 0] / (2 * np.maximum(at, 1e-9 * curve.root_limit))
        rate = np.where(contact & (beyond > 0), np.minimum(rate, 1e3 * curve.steepness), 0.0)
        force = np.where(contact, force, 0.0)
        # Below its end the branch goes on steeply, so that rows in contact pull it along, and rows
        # that have no contact push it above them.
        steepness = np.where(contact & (beyond <= 0), curve.steepness, 0.0)
        if self.ended is not None:
            steepness = np.where(
                self.ended & (beyond > 0), -curve.steepness * _BARRIER / _PENALTY, steepness
            )
        by_parameter = {
            p: np.where(contact, force_by - rate * position_by, 0.0) - steepness * end_by
            for p, position_by, force_by, end_by in zip(
                self.parameters, changes[::2], changes[1::2], curve.end_by, strict=True
            )
        }
        return ModelForce(force + steepness * beyond, rate + steepness, by_parameter)

    def end(self, values: Values, deepest: float) -> float:
        """Return the base position over the contact point [m] at which the contact breaks."""
        return float(self._stable(values, deepest).position[0])

    def jump(self, values: Values, deepest: float) -> float:
        """Return the force [N] to which an approach jumps as it touches."""
        stable = self._stable(values, deepest)
        return float(np.interp(0.0, stable.position, stable.force))

    def pull_off(self, values: Values) -> float:
        """Return the least force [N] of the branch that a dead load can follow."""
        free = AdhesiveModel(self.elastic, self.moves_out, self.attached, None)
        return float(free._stable(values, 0.0).force.min())

    def _stable(self, values: Values, deepest: float) -> _Branch:
        """Return the stable branch up to a base position [m], from its end on."""
        work, modulus = values[WORK_OF_ADHESION], values[MODULUS]
        tiny = float(np.finfo(float).tiny) ** 0.25
        scale = max(deepest, work / modulus, tiny)
        grid, position = self._searched(float(np.log(scale)), deepest, values)
        top, index = float(grid[-1]), int(np.argmin(position))
        start, width = float(grid[index]), float(grid[1] - grid[0])
        if 0 < index < grid.size - 1:
            around = position[index - 1 : index + 2]
            for number in range(2):
                if number:
                    at = start + width * np.array([-1.0, 0.0, 1.0])
                    around, _ = self._equilibria(np.exp(at), values)
                below, middle, above = around.tolist()
                bend = below - 2 * middle + above
                if bend > 0:
                    start += width * float(np.clip((below - above) / (2 * bend), -1.0, 1.0))
                width /= 10
        nodes = np.exp(start + (top - start) * np.linspace(0, 1, _NODES) ** 2)
        softness = 0.0 if self.stiffness is None else 1 / self.stiffness
        elastic, retraction = self._superposed(nodes, values)
        force = modulus * (elastic.force - elastic.by_depth * retraction)
        tension = values[TENSION]
        step = max(_STEP * tension, 1e-5 * modulus * scale)
        varied, other = self._superposed(nodes, {**values, TENSION: tension + step})
        by_tension = (
            -(other - retraction) / step,
            (modulus * (varied.force - varied.by_depth * other) - force) / step,
        )
        by_work = -retraction / (2 * work), -elastic.by_depth * modulus * retraction / (2 * work)
        # At equal depths forces are homogeneous in E*, τ₀ and w, of degree 1, and D of degree 0.
        depth_by, force_by = (
            (tension * t + work * w) / modulus for t, w in zip(by_tension, by_work, strict=True)
        )
        by_modulus = -depth_by, force / modulus - force_by
        changes = tuple(
            (depth + softness * change, change)
            for depth, change in (by_modulus, by_tension, by_work)
        )
        return _Branch(nodes - retraction + softness * force, force, changes)

    def _searched(self, start: float, deepest: float, values: Values) -> tuple[Array, Array]:
        """Return logarithms of depths without adhesion, and base positions [m] up to one beyond."""
        step = _DECADES * float(np.log(10)) / _SEARCH
        grid = np.asarray(start + step * np.arange(-_SEARCH, _BEYOND), dtype=np.float64)
        for _ in range(80):
            position, force = self._equilibria(np.exp(grid), values)
            beyond = (position > deepest) & (force > 0)
            last = _SEARCH + int(np.argmax(beyond[_SEARCH:]))
            if beyond[last]:
                return grid[: last + 1], position[: last + 1]
            grid = grid + step * (_BEYOND - 1)
        raise ConfigError(
            f"of {readable(values[WORK_OF_ADHESION], 'J/m**2', 3)} pulls a solid of "
            f"{readable(values[MODULUS], 'Pa', 3)} out "
            "without end",
            "work_of_adhesion",
        )

    def _superposed(self, depth: Array, values: Values) -> tuple[Any, Array]:
        """Return the contact without adhesion over E*, and the retraction D [m]."""
        modulus = values[MODULUS]
        length = 2 * values[TENSION] / modulus
        elastic = self.elastic.force_curve(depth, length)
        contact = self._radius.contact_radius(depth, length)
        energy = 4 * np.pi * values[WORK_OF_ADHESION] / modulus
        return elastic, np.sqrt(energy * contact.radius / contact.stiffness_slope)

    def _equilibria(self, depth: Array, values: Values) -> tuple[Array, Array]:
        """Return base position [m] and force [N], of depths without adhesion [m]."""
        elastic, retraction = self._superposed(depth, values)
        force = values[MODULUS] * (elastic.force - elastic.by_depth * retraction)
        bending = 0.0 if self.stiffness is None else force / self.stiffness
        return depth - retraction + bending, force

    def guesses(self, span: float) -> Iterator[Values]:
        """Yield E* = 1 Pa with tensions and works of adhesion from little to much."""
        for length in _LENGTHS:
            for work in _WORKS:
                yield {
                    MODULUS: 1.0,
                    TENSION: length * span / 2,
                    WORK_OF_ADHESION: work * span,
                }

    def scaled(self, values: Values, factor: float) -> Values:
        """Return all values times ``factor``."""
        return {parameter: factor * value for parameter, value in values.items()}

    def description(self) -> dict[str, Any]:
        """Return the indenter and the adhesion as JSON data."""
        return self.elastic.description() | {"adhesion": "equilibrium"}


@lru_cache(maxsize=16)
def _curve(model: AdhesiveModel, values: tuple[float, ...], deepest: float) -> _Curve:
    """Return the stable branch up to a base position [m], at values of the model's parameters."""
    branch = model._stable(dict(zip(model.parameters, values, strict=True)), deepest)
    end = float(branch.position[0])
    root = np.sqrt(np.maximum(branch.position - end, 0.0))
    highest = np.maximum.accumulate(root)
    keep = np.concatenate([[True], root[1:] > highest[:-1]])
    columns = [branch.force, *(part for pair in branch.by_parameter for part in pair)]
    return _Curve(
        end,
        tuple(float(position_by[0]) for position_by, _ in branch.by_parameter),
        float(root[-1]),
        _PENALTY * float(np.ptp(branch.force)) / float(np.ptp(branch.position)),
        CubicSpline(root[keep], np.column_stack(columns)[keep]),
    )


def attachment(base: Array, force: Array, moves_out: Mask) -> Array:
    """Return which rows touch, as jumps of the force show: 1, −1 or 0 for unknown, of shape (n,).

    Deeper by one row, the force falls where the indenter snaps in and where it has not snapped off.
    """
    states = np.zeros(force.size)
    for rows in (np.flatnonzero(~moves_out), np.flatnonzero(moves_out)):
        if rows.size < 4 * _WIDTH:
            continue
        deeper = rows[np.argsort(base[rows], kind="stable")]
        jump = _jump(-force[deeper])
        if jump is not None:
            states[deeper[: jump + 1]] = -1
            states[deeper[jump + 1 :]] = 1
    return states


def _jump(force: Array) -> int | None:
    """Return the row, in order of position, after which the force jumps up; None if none does."""
    bends = np.diff(force, 2)
    noise = 1.4826 / np.sqrt(6) * float(np.median(np.abs(bends)))
    sums = np.cumsum(np.concatenate([[0.0], force]))
    means = (sums[_WIDTH:] - sums[:-_WIDTH]) / _WIDTH
    rises = means[_WIDTH:] - means[:-_WIDTH]
    index = int(np.argmax(rises))
    if rises[index] <= _SIGNIFICANT * noise * np.sqrt(2 / _WIDTH) or rises[index] <= 0:
        return None
    near = np.arange(index, index + 2 * _WIDTH - 1)
    return int(near[np.argmax(np.diff(force)[near])])
