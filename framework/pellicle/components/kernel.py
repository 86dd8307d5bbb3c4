"""The contract of kernels."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

from pellicle.arrays import Array

from .base import Component


class Kernel(Component):
    """The displacement of the surface under pressure: û(q) = G(q) p̂(q).

    Only G(q) is required. On free boundaries the closed form (`pellicle.operators.HasClosedForm`),
    ``greens_function(r)`` [m/N] and ``radial_primitive(r)`` [m³/N], is used if the kernel has one;
    otherwise it is tabulated from G(q). On periodic boundaries a uniform pressure causes no
    displacement unless the kernel also has `pellicle.operators.HasMeanCompliance`.
    """

    family: ClassVar[str] = "kernel"

    @abstractmethod
    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa], of the shape of ``q`` > 0 [rad/m]."""
