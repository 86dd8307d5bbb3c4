"""The contract of kernels."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar, Protocol, runtime_checkable

from pellicle.arrays import Array
from pellicle.contact.time_step import Branch

from .base import Component


class Kernel(Component):
    """The displacement of the surface under pressure: û(q) = G(q) p̂(q).

    Only G(q) is required. On free boundaries the closed form (`pellicle.surface.HasClosedForm`),
    ``greens_function(r)`` [m/N] and ``radial_primitive(r)`` [m³/N], is used if the kernel has one;
    otherwise it is tabulated from G(q). On periodic boundaries a uniform pressure causes no
    displacement unless the kernel also has `pellicle.surface.HasMeanCompliance`.
    """

    family: ClassVar[str] = "kernel"
    place: ClassVar[str] = "kernel"

    @abstractmethod
    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa], of the shape of ``q`` > 0 [rad/m]."""


@runtime_checkable
class HasRelaxation(Protocol):
    """A kernel whose solid relaxes in time; its ``compliance(q)`` is the instantaneous response.

    A skin on the solid does not relax: at a time t after a jump the stiffness is
    1/G(q) − Σ gⱼ (1 − e^(−t/τⱼ))/G₀(q), with G₀ the compliance of `without_skin`, and shares gⱼ and
    times τⱼ of `branches`.
    """

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] of the instantaneous response."""
        ...

    def branches(self) -> tuple[Branch, ...]:
        """Return the branches of the solid; none if it is elastic.

        Their shares sum to at most 1. If they sum to 1, the solid is a liquid.
        """
        ...

    def scaled(self, share: float) -> Kernel:
        """Return the elastic kernel of a solid ``share`` > 0 times as stiff under the same skin.

        Its compliance is 1/(1/G + (share − 1)/G₀).
        """
        ...

    def without_skin(self) -> Kernel:
        """Return the kernel of the solid alone: this kernel itself if it has no skin."""
        ...


@runtime_checkable
class MayBeBondedLayer(Protocol):
    """A kernel that may be an elastic layer bonded to a rigid base, under a tension at most."""

    def bonded_layer(self) -> tuple[float, float] | None:
        """Return thickness [m] and Poisson's ratio of the layer; None if it is anything else."""
        ...


@runtime_checkable
class HasTimeSpan(Protocol):
    """A kernel whose relaxation is meant for some times only."""

    def time_span(self) -> tuple[float, float]:
        """Return the shortest and the longest time [s] after a jump at which it holds.

        A run with a shorter step, or one that lasts longer, is refused.
        """
        ...
