"""One measured curve, cleaned: which rows are used, and what is wrong with the rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.errors import ConfigError, shown

Segment = Literal["approach", "retract"]

FEWEST = 8
"""Points that a fit needs at least."""
_FEW = 30
_ALIKE = 1e6
"""Stiffness of a cantilever over that of a curve, or the reverse, that is fitted at most."""
LARGEST = 1e30
"""Largest number in SI units that is fitted, and one over the smallest."""
_PASS = 0.5
"""A change of direction counts if the position then moves by this share of its range."""
_SEEN = 4.0
"""Standard errors that the rise of the force must exceed."""


@dataclass(frozen=True)
class Curve:
    """Position [m], growing into the solid, and force [N] of one approach, in order of position."""

    position: Array
    force: Array
    messages: tuple[str, ...] = ()
    """What was left out, and what to be careful of."""
    stiffness: float | None = None
    """Of the cantilever [N/m], if its deflection was subtracted to get the position."""


def clean(
    position: ArrayLike,
    force: ArrayLike,
    segment: Segment = "approach",
    stiffness: float | None = None,
) -> Curve:
    """Return the rows of one pass into the solid (or out of it), in order of position.

    Where the ``stiffness`` [N/m] of a cantilever is known its base, which has no noise, tells the
    passes apart.

    Raises
    ------
    ConfigError
        Shapes that differ, too few points, several passes, the other pass only, force that falls
        as the position grows, or no rise of the force at all.
    """
    z, f = _array(position, "position"), _array(force, "force")
    if z.shape != f.shape:
        raise ConfigError(
            f"has {f.size} values and position {z.size}; give one for each position", "force"
        )
    messages = []
    known = np.isfinite(z) & np.isfinite(f)
    if missing := int(np.sum(~known)):
        messages.append(f"{missing} of {z.size} rows hold no finite number and were left out")
        z, f = z[known], f[known]
    _enough(z, "the curve")
    _in_si(z, "position", "m")
    _in_si(f, "force", "N")
    span = float(np.ptp(z))
    if not span:
        raise ConfigError(f"is {z[0]:g} m in every row; give a curve that moves", "position")
    base = z if stiffness is None else _base(z, f, stiffness)
    _stiffens(base, f)
    rows = _one_pass(base, segment, messages)
    z, f, base = z[rows], f[rows], base[rows]
    _enough(z, f"its {segment}")
    # The position of a tip holds the noise of the force: in its order, the noise has a slope.
    order = np.argsort(base, kind="stable")
    z, f = z[order], f[order]
    if z.size < _FEW:
        messages.append(f"only {z.size} points: expect wide intervals")
    if np.unique(z).size < FEWEST:
        raise ConfigError(
            f"has {np.unique(z).size} different values; give at least {FEWEST}", "position"
        )
    return Curve(z, f, tuple(messages), stiffness)


def _array(values: ArrayLike, name: str) -> Array:
    if np.iscomplexobj(values):
        raise ConfigError("holds complex numbers; give real values in SI", name)
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise ConfigError(f"{shown(values)} is no list of numbers; give SI values", name) from None
    if array.ndim != 1:
        raise ConfigError(f"is of shape {array.shape}; give a list, one curve at a time", name)
    return array


def _base(z: Array, f: Array, stiffness: float) -> Array:
    """Return the position of the cantilever's base [m].

    Raises
    ------
    ConfigError
        Its deflection is of another order than the position.
    """
    deflection = float(np.ptp(f)) / float(np.ptp(z))
    if not 1 / _ALIKE <= deflection / stiffness <= _ALIKE:
        raise ConfigError(
            f"of {stiffness:.3g} N/m is far from the {deflection:.3g} N/m that this curve has "
            "itself, so that one of force and deflection is nothing beside the other; give that of "
            "the cantilever with its unit",
            "spring_constant",
        )
    return z + f / stiffness


def _in_si(values: Array, name: str, unit: str) -> None:
    """Raise if values are so large or small that they cannot be what they are called."""
    largest = float(np.max(np.abs(values)))
    if largest and not 1 / LARGEST <= largest <= LARGEST:
        raise ConfigError(
            f"reaches {largest:.3g} {unit}, and must reach between {1 / LARGEST:g} and "
            f"{LARGEST:g} {unit}: give SI values",
            name,
        )


def _enough(z: Array, what: str) -> None:
    if z.size < FEWEST:
        raise ConfigError(f"{what} has {z.size} points; a fit needs at least {FEWEST}", "position")


def _stiffens(z: Array, f: Array) -> None:
    """Raise unless the force is higher at the greatest positions than at the least."""
    order = np.argsort(z, kind="stable")
    tenth = max(z.size // 10, 2)
    low, high = f[order[:tenth]], f[order[-tenth:]]
    rise = float(high.mean() - low.mean())
    # Neighbours differ by noise and by the slope, so this is too high if anything.
    noise = float(np.sqrt(np.mean(np.diff(f[order]) ** 2) / 2))
    least = _SEEN * noise * np.sqrt(2 / tenth)
    if rise < -least:
        raise ConfigError(
            f"falls by {-rise:.3g} N as the position grows: a negative stiffness; position must "
            "grow into the solid and force must push back, so change the sign of one of them",
            "force",
        )
    if rise <= least or not rise:
        raise ConfigError(
            f"does not rise with the position (by {rise:.2g} N at a noise of {noise:.2g} N): there "
            "is no contact in the curve; give one that goes deeper",
            "force",
        )


def _one_pass(z: Array, segment: Segment, messages: list[str]) -> slice:
    """Return the rows that move into the solid, or out of it."""
    turns = _turns(z, _PASS * float(np.ptp(z)))
    passes = list(zip([0, *turns], [*turns, z.size - 1], strict=True))
    inward = [bool(z[last] > z[first]) for first, last in passes]
    if len(passes) > 2:
        raise ConfigError(
            f"goes to and fro {len(passes)} times: several curves, or rows out of order; give one "
            "curve at a time, its rows in order",
            "position",
        )
    wanted = segment == "approach"
    if wanted not in inward:
        found = "retract" if wanted else "approach"
        raise ConfigError(
            f"only moves {'out of' if wanted else 'into'} the solid: this is a {found} and the "
            f"{segment} is asked; give the {segment}, or ask for segment {found!r}",
            "position",
        )
    first, last = passes[inward.index(wanted)]
    # A retract begins where a dwell at the turn ends.
    while first and z[first + 1] == z[first]:
        first += 1
    if len(passes) > 1:
        messages.append(
            f"rows {first + 1} to {last + 1} are the {segment}; "
            f"the other {z.size - 1 - last + first} were left out"
        )
    if not wanted:
        messages.append("a retract is fitted as if nothing adhered: compare with the approach")
    return slice(first, last + 1)


def _turns(z: Array, least: float) -> list[int]:
    """Return the first rows of those where the direction changes for at least this far."""
    turns: list[int] = []
    low = high = 0
    direction = 0
    for row, here in enumerate(z.tolist()):
        if here > z[high]:
            high = row
        if here < z[low]:
            low = row
        if direction >= 0 and z[high] - here >= least:
            if direction:
                turns.append(high)
            direction, low = -1, row
        elif direction <= 0 and here - z[low] >= least:
            if direction:
                turns.append(low)
            direction, high = 1, row
    return turns
