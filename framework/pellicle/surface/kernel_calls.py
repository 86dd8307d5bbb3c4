"""Calls of a kernel: what operators need of it, and the checks of its values."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol, runtime_checkable

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import component_name, errors_attributed_to, read_only, real_array, real_number
from pellicle.errors import ConfigError


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
