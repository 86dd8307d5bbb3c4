"""Rules of kernels: the compliance, its closed form and the operators agree."""

from __future__ import annotations

import math

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import read_only
from pellicle.components.kernel import Kernel, branches_of
from pellicle.contact.time_step import have_equal_branches
from pellicle.errors import excerpt
from pellicle.grid import Grid
from pellicle.surface.from_kernel import (
    checked_call,
    closed_form_of,
    mean_compliance,
    words_of_call,
)

from .closed_form import displacement_by_primitive, displacement_of_centre
from .rule import Case, difference

# Relative rounding error of formulas that nearly cancel.
_ROUNDING = 1e-9
# Relative growth of G(q) with q that is more than rounding, and the factors on the grid's largest q
# at which it is measured.
_GROWTH = 1e-6
_SHORTER = np.geomspace(1.0, 1e12, 13)
# Relative difference that an approximate closed form may have; a wrong one differs by more.
_ALLOWED = 1e-3
_CELLS = 2.0  # width of the narrow Gaussian in cells
_SHARE = 0.25  # width of the wide Gaussian over the domain
_FORMS = ("greens_function", "radial_primitive")


def _waves(grid: Grid, number: int = 24) -> Array:
    """Return wavenumbers [rad/m] from the diagonal of the domain to that of a cell."""
    return np.geomspace(1 / math.hypot(*grid.size), _shortest(grid), number)


def _shortest(grid: Grid) -> float:
    return math.pi * math.hypot(*(1 / spacing for spacing in grid.spacing))


def _lengths(grid: Grid) -> tuple[float, float]:
    """Return the width of a cell and the diagonal of the domain [m]."""
    return min(grid.spacing), math.hypot(*grid.size)


def _vectors(kernel: Kernel, q: Array) -> tuple[Array, Array]:
    """Return waves of each q: along x of a kernel that is isotropic, else along four directions."""
    angles = np.array([0.0] if kernel.is_isotropic else [0.0, 0.25, 0.5, 0.75]) * np.pi
    return np.outer(np.cos(angles), q).ravel(), np.outer(np.sin(angles), q).ravel()


def compliance_is_positive_and_finite(kernel: Kernel, case: Case) -> str:
    """The compliance is positive and finite for every wave of a grid."""
    qx, qy = _vectors(kernel, _waves(case.grid, 200))
    values = np.asarray(
        kernel.compliance(qx.copy()) if kernel.is_isotropic else kernel.symbol(qx, qy)
    )
    if not np.issubdtype(values.dtype, np.number):
        return f"compliance is an array of {values.dtype}"
    bad = np.flatnonzero(~(np.isfinite(values) & (values > 0)))
    if not bad.size:
        return ""
    return (
        f"compliance is {values[bad[0]]:g} m/Pa at q = {math.hypot(qx[bad[0]], qy[bad[0]]):g} rad/m"
    )


def values_are_of_their_argument_alone(kernel: Kernel, case: Case) -> str:
    """The symbol and the closed form are float arrays of the shape of their argument.

    Each value depends on its own q or r alone, which stays as it is, and is the same every time.
    """
    q, r = _waves(case.grid), np.geomspace(*_lengths(case.grid), 24)
    first = "compliance" if kernel.is_isotropic else "symbol"
    for name, argument in {first: q, **dict.fromkeys(_FORMS, r)}.items():
        if not hasattr(kernel, name):
            continue
        function, slopes = checked_call(kernel, name), [1.0] + [0.3] * (name == "symbol")
        singles = (
            [slope * value for slope in slopes] for value in np.split(argument, argument.size)
        )
        singly = np.concatenate([function(*values) for values in singles])
        for shape in ((24,), (4, 6), (2, 3, 4)):
            words = f"{name}() for an argument of shape {shape}"
            expected = singly.reshape(shape)
            values = function(*(slope * argument.reshape(shape) for slope in slopes))
            if differs := difference(values, expected, words, relative=_ROUNDING):
                return differs
    return ""


def symbol_is_even_and_broadcast(kernel: Kernel, case: Case) -> str:
    """symbol(qx, qy) is even and broadcast; it is compliance(q) if the kernel is isotropic."""
    qx, qy = _waves(case.grid, 6)[:, None], -1.3 * _waves(case.grid, 5)
    name, values = words_of_call(kernel), np.asarray(kernel.symbol(qx, qy))
    every = checked_call(kernel, "symbol")(*(q.copy() for q in np.broadcast_arrays(-qx, -qy)))
    if differs := difference(values, every, f"{name} of −q", relative=_ROUNDING):
        return differs
    if not kernel.is_isotropic:
        return ""
    expected = kernel.compliance(np.hypot(qx, qy))
    return difference(values, expected, "symbol(qx, qy) [m/Pa]", relative=_ROUNDING)


def compliance_does_not_grow_for_short_waves(kernel: Kernel, case: Case) -> str:
    """For short waves the compliance falls with q, or tends to a constant.

    For short waves a solid is a half-space, with G(q) ∝ 1/q; for a bed of springs G(q) is constant.
    G(q) of an incompressible layer grows with q down to waves about as long as the layer is thick.
    These may be shorter than the grid's waves, so still shorter waves are checked.
    """
    shortest = _shortest(case.grid)
    for x, y in ((1.0, 0.0), (0.0, 1.0)):
        halves = shortest * np.array([0.5, 1.0])
        half, last = kernel.symbol(x * halves, y * halves)
        if not last > half * (1 + _GROWTH):
            continue
        q = shortest * _SHORTER
        values = kernel.symbol(x * q, y * q)
        # A formula may overflow far beyond the grid.
        known = int(np.argmin(np.append(np.isfinite(values), False)))
        if known >= 2 and values[known - 1] <= values[known - 2] * (1 + _GROWTH):
            continue
        return (
            f"{words_of_call(kernel)} grows from {half:.3g} m/Pa at {shortest / 2:.3g} rad/m to "
            f"{values[known - 1]:.3g} m/Pa at {q[known - 1]:.3g} rad/m"
        )
    return ""


def branches_have_shares_and_times(kernel: Kernel, case: Case) -> str:
    """branches() returns pairs of a share > 0 and a time > 0, whose shares sum to at most 1.

    A time that depends on the wave is a function of q, positive and finite for q > 0.
    """
    q = _waves(case.grid)
    for branch in branches_of(kernel):
        with np.errstate(all="ignore"):
            times = np.asarray(branch.time_at(read_only(q.copy())))
        wrong = times.shape not in ((), q.shape) or not (np.isfinite(times) & (times > 0)).all()
        if wrong:
            return (
                f"the time of a branch is {excerpt(times.tolist())} s at q = {excerpt(q.tolist())}"
            )
    return ""


def scaled_by_one_is_the_kernel(kernel: Kernel, case: Case) -> str:
    """scaled(1) is elastic, with the compliance and the mean compliance of the kernel."""
    elastic, waves = kernel.scaled(1.0), _vectors(kernel, _waves(case.grid))
    if branches_of(elastic):
        return f"scaled(1) has the branches {branches_of(elastic)}"
    return difference(
        elastic.symbol(*waves),
        kernel.symbol(*waves),
        "the compliance [m/Pa] of scaled(1)",
        relative=_ROUNDING,
    ) or difference(
        mean_compliance(elastic),
        mean_compliance(kernel),
        "mean_compliance() [m/Pa] of scaled(1)",
        relative=_ROUNDING,
    )


def scaled_stiffens_the_solid_alone(kernel: Kernel, case: Case) -> str:
    """The stiffness of scaled(share) is 1/G + (share − 1)/G₀, with G₀ of without_skin()."""
    waves = _vectors(kernel, _waves(case.grid))
    whole, solid = 1 / kernel.symbol(*waves), 1 / kernel.without_skin().symbol(*waves)
    for share in (0.01, 0.5, 3.0):
        if differs := difference(
            1 / kernel.scaled(share).symbol(*waves),
            whole + (share - 1) * solid,
            f"the stiffness [Pa/m] of scaled({share:g})",
            relative=_ROUNDING,
        ):
            return differs
    return ""


def without_skin_has_no_skin(kernel: Kernel, case: Case) -> str:
    """The solid without its skin relaxes as the kernel does, and has no skin to take off."""
    solid, waves = kernel.without_skin(), _vectors(kernel, _waves(case.grid))
    if not have_equal_branches(branches_of(solid), branches_of(kernel)):
        wrong = "relaxes as another kernel does" if branches_of(solid) else "does not relax"
        return f"without_skin() {wrong}"
    return difference(
        solid.without_skin().symbol(*waves),
        solid.symbol(*waves),
        "the compliance [m/Pa] of without_skin().without_skin()",
        relative=_ROUNDING,
    )


def closed_form_is_whole(kernel: Kernel, case: Case) -> str:
    """A kernel has both of greens_function and radial_primitive, or neither."""
    present = [name for name in _FORMS if hasattr(kernel, name)]
    return f"{' '.join(present)} alone is defined" if len(present) == 1 else ""


def primitive_is_the_integral_of_the_closed_form(kernel: Kernel, case: Case) -> str:
    """radial_primitive is 0 at r = 0 and grows by ∫ greens_function r dr."""
    form = closed_form_of(kernel)
    if form is None or not kernel.is_isotropic:
        return ""
    cell, size = _lengths(case.grid)
    at_zero, at_cell = form.radial_primitive(np.array([0.0, cell]))
    if not abs(at_zero) <= _ROUNDING * abs(at_cell):
        return f"radial_primitive(0) is {at_zero:g} m³/N, and {at_cell:g} at r = {cell:g} m"
    edges = np.linspace(np.log(cell), np.log(size), 2 + int(np.log(size / cell)))
    points, weights = np.polynomial.legendre.leggauss(16)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    r = np.exp(middle[:, None] + half[:, None] * points)
    integral = float((half[:, None] * weights * form.greens_function(r) * r**2).sum())
    start, end = form.radial_primitive(np.array([cell, size]))
    if abs(end - start - integral) <= _ALLOWED * max(abs(start), abs(end)):
        return ""
    return (
        f"radial_primitive(r) grows by {end - start:.6g} m³/N from r = {cell:.3g} m to "
        f"{size:.3g} m, and the integral of greens_function(r) r by {integral:.6g} m³/N"
    )


def closed_form_is_the_transform_of_the_compliance(kernel: Kernel, case: Case) -> str:
    """At the centre of a Gaussian pressure, radial_primitive and compliance agree."""
    form = closed_form_of(kernel)
    if form is None or not kernel.is_isotropic:
        return ""
    cell, size = _lengths(case.grid)
    for width in (_CELLS * cell, _SHARE * size):
        by_compliance = displacement_of_centre(kernel.compliance, width)
        by_primitive = displacement_by_primitive(form.radial_primitive, width)
        if not abs(by_primitive - by_compliance) <= _ALLOWED * by_compliance:
            return (
                f"radial_primitive(r) gives {by_primitive:.6g} m at the centre of a Gaussian "
                f"pressure of 1 Pa and standard deviation {width:.3g} m, compliance(q) "
                f"{by_compliance:.6g} m"
            )
    return ""
