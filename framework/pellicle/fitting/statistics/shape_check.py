"""What the true shape changes where its shallow limit is pressed in too deep."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import chdtri

from pellicle.arrays import Array
from pellicle.components import HasForceCurve, IsShallowLimit
from pellicle.errors import ConvergenceError

from .interval import CONFIDENCE
from .likelihood import MODULUS, POINT, TENSION, ChiSquared, Likelihood, Minimum
from .pooled_likelihood import Pool
from .residuals import FailedCheck

SHALLOW = 0.1
"""Depth over radius beyond which a paraboloid is not the sphere that it stands for."""
_ALIKE = 10.8
"""Rise of χ² up to which another shape explains a curve as well: by chance in 0.1 %."""


def whole_shape(likelihood: Likelihood, parameters: Array) -> HasForceCurve | None:
    """Return the shape that the indenter stands for, if it is pressed in deeper than that holds.

    None if the shape itself ends above that depth, too.
    """
    limit = likelihood.indenter
    if not isinstance(limit, IsShallowLimit):
        return None
    depth = float(likelihood.position[-1] - parameters[POINT])
    shape = limit.whole_shape()
    return shape if SHALLOW * limit.radius < depth <= shape.depth_limit else None


def check_shape(likelihood: Likelihood, best: Minimum) -> tuple[list[str], list[FailedCheck]]:
    """Return what the true shape changes, and whether it makes the tension unnecessary.

    The check fails if the true shape explains the curve without tension as well as its shallow
    limit does with a tension that it needs.
    """
    shape = whole_shape(likelihood, best.parameters)
    if shape is None:
        return [], []
    other = replace(likelihood, indenter=shape)
    try:
        free = other.minimise(best.parameters)
        fails = explains_without_tension(other, free, likelihood, best)
    except ConvergenceError:
        return [], []
    words = _words(likelihood, best.parameters, shape, free.parameters)
    if not fails:
        return [words], []
    return [], [FailedCheck("shape", f"{words}; it explains the curve as well without tension")]


def check_pooled_shape(pool: Pool, best: Minimum) -> list[FailedCheck]:
    """Return whether the true shapes make the tension of several curves unnecessary."""
    members, count = [], 0
    for member, part in zip(pool.members, pool.parts(best.parameters), strict=True):
        shape = whole_shape(member, part)
        members.append(member if shape is None else replace(member, indenter=shape))
        count += shape is not None
    if not count:
        return []
    other = Pool(tuple(members), pool.free)
    try:
        fails = explains_without_tension(other, other.minimise(best.parameters), pool, best)
    except ConvergenceError:
        return []
    text = (
        f"{count} of {len(members)} curves go deeper than {SHALLOW:g} of the radius, and the "
        "shapes that their indenters stand for explain the curves as well without tension"
    )
    return [FailedCheck("shape", text)] if fails else []


def explains_without_tension(
    other: ChiSquared, minimum: Minimum, chi_squared: ChiSquared, best: Minimum
) -> bool:
    """Return whether another model does without tension what this one needs a tension for."""
    if TENSION not in chi_squared.free or not best.parameters[TENSION]:
        return False
    needed = _without_tension(chi_squared, best) - best.chi_squared > chdtri(1, 1 - CONFIDENCE)
    return needed and _without_tension(other, minimum) < best.chi_squared + _ALIKE


def _without_tension(chi_squared: ChiSquared, minimum: Minimum) -> float:
    """Return the least χ² without tension near a minimum with tension."""
    start = minimum.parameters.copy()
    start[TENSION] = 0.0
    return chi_squared.minimise(start, (TENSION,)).chi_squared


def _words(likelihood: Likelihood, parameters: Array, shape: HasForceCurve, others: Array) -> str:
    limit = likelihood.indenter
    assert isinstance(limit, IsShallowLimit)
    share = float(likelihood.position[-1] - parameters[POINT]) / limit.radius
    name, whole = (getattr(it, "type", type(it).__name__) for it in (limit, shape))
    return (
        f"the depth is {share:.2g} of the radius, and beyond {SHALLOW:g} of it a {name} is not the "
        f"{whole} that it stands for: with indenter {whole!r} the reduced modulus is "
        f"{np.exp(others[MODULUS]):.4g} Pa and the tension {others[TENSION]:.3g} N/m"
    )
