"""The contract of kernels."""

from __future__ import annotations

from abc import abstractmethod
from typing import (
    ClassVar,
)

from pellicle.arrays import Array

from .base import Component


class Kernel(Component):
    """How the surface yields to pressure: û(q) = G(q) p̂(q).

    That is all it needs to give. On free boundaries its closed form, ``greens_function(r)`` [m/N]
    and ``radial_primitive(r)`` [m³/N] as in `pellicle.operators.HasClosedForm`, is used if it has
    one, and is otherwise tabulated from G(q). On periodic ones a uniform
    pressure has no displacement unless it also has `pellicle.operators.HasMeanCompliance`.
    """

    family: ClassVar[str] = "kernel"

    @abstractmethod
    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa], of the shape of ``q`` > 0 [rad/m]."""
