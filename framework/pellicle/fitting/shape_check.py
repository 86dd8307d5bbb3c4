"""What the true shape changes where its shallow limit is pressed in too deep."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import chdtri

from pellicle.components import IsShallowLimit

from .interval import CONFIDENCE
from .likelihood import MODULUS, POINT, TENSION, Likelihood, Minimum
from .residuals import FailedCheck

SHALLOW = 0.1
"""Depth over radius beyond which a paraboloid is not the sphere that it stands for."""
_ALIKE = 10.8
"""Rise of χ² up to which another shape explains a curve as well: by chance in 0.1 %."""


def _without_tension(likelihood: Likelihood, minimum: Minimum) -> float:
    """Return the least χ² without tension near a minimum with tension."""
    start = minimum.parameters.copy()
    start[TENSION] = 0.0
    return likelihood.minimise(start, (TENSION,)).chi_squared


def check_shape(likelihood: Likelihood, best: Minimum) -> tuple[list[str], list[FailedCheck]]:
    """Return what the true shape changes, and whether it makes the tension unnecessary.

    The check fails if the true shape explains the curve without tension as well as its shallow
    limit does with tension.
    """
    limit = likelihood.indenter
    if not isinstance(limit, IsShallowLimit):
        return [], []
    depth = float(likelihood.position[-1] - best.parameters[POINT])
    if depth <= SHALLOW * limit.radius:
        return [], []
    shape = limit.whole_shape()
    name, whole = (getattr(each, "type", type(each).__name__) for each in (limit, shape))
    words = (
        f"the depth is {depth / limit.radius:.2g} of the radius, and beyond {SHALLOW:g} of it a "
        f"{name} is not the {whole} that it stands for"
    )
    if depth > shape.depth_limit:
        return [f"{words}, whose curve ends at {shape.depth_limit:.3g} m"], []
    other = replace(likelihood, indenter=shape)
    free = other.minimise(best.parameters)
    modulus, tension = np.exp(free.parameters[MODULUS]), free.parameters[TENSION]
    words += (
        f": with indenter {whole!r} the reduced modulus is {modulus:.4g} Pa and the tension "
        f"{tension:.3g} N/m"
    )
    if TENSION not in likelihood.free or not best.parameters[TENSION]:
        return [words], []
    needs = _without_tension(likelihood, best) - best.chi_squared > chdtri(1, 1 - CONFIDENCE)
    if not needs or _without_tension(other, free) > best.chi_squared + _ALIKE:
        return [words], []
    words += f", and the {whole} explains the curve as well without tension"
    return [], [FailedCheck("shape", words)]
