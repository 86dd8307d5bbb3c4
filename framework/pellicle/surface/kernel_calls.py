"""Calls of a kernel: what operators need of it, and the checks of its values."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol, runtime_checkable

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import component_name, errors_attributed_to, read_only, real_array, real_number
from pellicle.errors import ConfigError, PluginError

# Factors on the grid's largest q at which G(q) is checked for growth.
_SHORTER = np.geomspace(1.0, 1e12, 13)
_GROWTH = 1e-6  # relative; less is rounding


class HasCompliance(Protocol):
    """The part of a kernel that every operator needs."""

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] for wavenumbers q > 0 [rad/m]."""
        ...


@runtime_checkable
class HasClosedForm(HasCompliance, Protocol):
    """A kernel with formulas in real space; other kernels are tabulated on a free boundary."""

    def greens_function(self, r: Array) -> Array:
        """Return the displacement at distances r > 0 [m] from a unit force [m/N]."""
        ...

    def radial_primitive(self, r: Array) -> Array:
        """Return ∫₀^r G(r') r' dr' [m³/N] for r ≥ 0 [m]."""
        ...


@runtime_checkable
class HasMeanCompliance(HasCompliance, Protocol):
    """A kernel that states the displacement of its surface under a uniform pressure."""

    def mean_compliance(self) -> float:
        """Return G(0) [m/Pa], the displacement per uniform pressure on a periodic domain.

        If it is infinite, the mean displacement is set to 0 and depths are measured from the mean
        plane.
        """
        ...


def mean_compliance(kernel: HasCompliance) -> float:
    """Return G(0) [m/Pa] of a kernel; ∞ if it does not state G(0), as for a half-space."""
    if not isinstance(kernel, HasMeanCompliance):
        return math.inf
    with errors_attributed_to(kernel):
        value = kernel.mean_compliance()
    return real_number(kernel, "mean_compliance()", value)


def checked_call(kernel: HasCompliance, name: str) -> Callable[[Array], Array]:
    """Return a method of a kernel, wrapped to protect its argument and check its values.

    The function raises PluginError if the kernel returns anything but an array of real
    numbers of the shape of its argument.
    """
    method = getattr(kernel, name)
    text = f"{name}({'q' if name == 'compliance' else 'r'})"

    def call(argument: Array) -> Array:
        with errors_attributed_to(kernel):
            values = method(read_only(argument))
        return real_array(kernel, text, values, argument.shape)

    return call


def positive_compliance(kernel: HasCompliance, q: Array, values: Array) -> Array:
    """Return the ``values`` of G [m/Pa] at q [rad/m]; refuse them unless positive and finite."""
    invalid = np.flatnonzero(~(np.isfinite(values) & (values > 0)))
    if invalid.size:
        raise ConfigError(
            f"compliance(q) of {component_name(kernel)} is {values[invalid[0]]:.3g} m/Pa at q = "
            f"{q[invalid[0]]:.3g} rad/m; it has to be positive and finite, and may be beyond the "
            "numbers that a computer has; check the parameters, or the formula if the kernel is "
            "yours",
            "kernel",
        )
    return values


def refuse_growth(
    kernel: HasCompliance, compliance: Callable[[Array], Array], shortest: float
) -> None:
    """Refuse a kernel whose G(q) grows with q at the grid's shortest waves and beyond.

    For short waves a solid is a half-space, with G(q) ∝ 1/q; for a bed of springs G(q) is constant.
    G(q) of an incompressible layer grows with q down to waves about as long as the layer is thick.
    These may be shorter than the grid's waves, so still shorter waves are checked. ``compliance``
    is the checked call, ``shortest`` the largest wavenumber of the grid [rad/m].
    """
    if not shortest > 0:
        return
    with np.errstate(all="ignore"):
        half, last = compliance(shortest * np.array([0.5, 1.0]))
        if not last > half * (1 + _GROWTH):
            return
        q: Array = shortest * _SHORTER
        values = compliance(q)
    # A formula may overflow far beyond the grid.
    known = int(np.argmin(np.append(np.isfinite(values), False)))
    if known < 2 or values[known - 1] > values[known - 2] * (1 + _GROWTH):
        raise PluginError(
            f"{component_name(kernel)}: compliance(q) grows with q, from {half:.3g} m/Pa at "
            f"{shortest / 2:.3g} rad/m to {values[known - 1]:.3g} m/Pa at {q[known - 1]:.3g} "
            "rad/m; for short waves it has to fall, or to tend to a constant"
        )
