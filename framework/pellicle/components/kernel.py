"""The contract of kernels, and kernels that are made of another one."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import Any, ClassVar, cast

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import component_name, errors_attributed_to, read_only, real_number
from pellicle.contact.time_step import Branch, OfWave
from pellicle.errors import ConfigError, PluginError, excerpt
from pellicle.plugins.component import Component
from pellicle.surface.from_kernel import HasClosedForm, closed_form_of, mean_compliance

# Rounding error of a sum of shares.
_ROUNDING = 1e-12


class Kernel(Component):
    """The displacement of the surface under pressure: û(q) = G(q) p̂(q).

    Only G(q) is required; the defaults of the other methods are those of an elastic half-space
    without a skin. A kernel that yields equally in all directions derives from `Isotropic`.

    If the solid relaxes in time, ``symbol(qx, qy)`` is its instantaneous response. A skin on the
    solid does not relax: at a time t after a jump the stiffness is
    1/G(q) − Σ gⱼ (1 − e^(−t/τⱼ))/G₀(q), with G₀ the compliance of `without_skin`, and shares gⱼ and
    times τⱼ of `branches`, numbers or functions of q. An elastic kernel may count a skin of its own
    as part of the solid.
    """

    family: ClassVar[str] = "kernel"
    place: ClassVar[str] = "kernel"

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        super().__pydantic_init_subclass__(**options)
        if "symbol" in cls.__abstractmethods__ and cls.compliance is not Kernel.compliance:
            raise PluginError(
                f"{cls.__name__} has compliance(q) and no symbol(qx, qy); derive it from "
                "pellicle.Isotropic, the kernels that compliance(q) describes in all directions"
            )

    @property
    def is_isotropic(self) -> bool:
        """Whether G depends on |q| alone; a free boundary needs that."""
        return False

    @abstractmethod
    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return G(q) [m/Pa] of waves q_x and q_y [rad/m], not both 0, which may be broadcast.

        It is real and even, G(−q) = G(q).
        """

    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa] of an isotropic kernel for q > 0 [rad/m]; refuse of any other."""
        if not self.is_isotropic:
            raise ConfigError(
                f"{component_name(self)} yields differently along x and y, so compliance(q) does "
                "not describe it; use symbol(qx, qy)",
                "kernel",
            )
        return self.symbol(q, np.zeros_like(q))

    def mean_compliance(self) -> float:
        """Return G(0) [m/Pa], the displacement per uniform pressure on a periodic domain.

        If it is infinite, the mean displacement is set to 0 and depths are measured from the mean
        plane.
        """
        return math.inf

    def branches(self) -> tuple[Branch, ...]:
        """Return the branches of the solid; none if it is elastic.

        Their shares sum to at most 1. If they sum to 1, the solid is a liquid.
        """
        return ()

    def time_span(self) -> tuple[float, float]:
        """Return the shortest and the longest time [s] after a jump at which the branches hold.

        A run with a shorter step, or one that lasts longer, is refused.
        """
        return 0.0, math.inf

    def without_skin(self) -> Kernel:
        """Return the kernel of the solid alone: this kernel itself if it has no skin."""
        return self

    def scaled(self, share: float | OfWave) -> Kernel:
        """Return the elastic kernel of a solid ``share`` > 0 times as stiff under the same skin.

        Its symbol is 1/(1/G + (share − 1)/G₀). The share is a number, with which it has a closed
        form if this kernel has one; or a function of q if times of `branches` are.
        """
        kind = _StiffenedClosedForm if closed_form_of(self) and not callable(share) else _Stiffened
        return kind.model_construct(substrate=self, factor=share)

    def depth_to_base(self) -> float:
        """Return the depth [m] of the rigid base under the solid; ∞ if there is none."""
        return math.inf


class Isotropic(Kernel):
    """A kernel that yields equally in all directions, given by one function of |q|.

    On free boundaries the closed form (`pellicle.surface.HasClosedForm`), ``greens_function(r)``
    [m/N] and ``radial_primitive(r)`` [m³/N], is used if the kernel has one; otherwise it is
    tabulated from G(q).
    """

    @property
    def is_isotropic(self) -> bool:
        """Whether G depends on |q| alone."""
        return True

    @abstractmethod
    def compliance(self, q: Array) -> Array:
        """Return G(q) [m/Pa], of the shape of ``q`` > 0 [rad/m]."""

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return G(|q|) [m/Pa] of waves q_x and q_y [rad/m]."""
        return self.compliance(read_only(np.hypot(qx, qy)))


class KernelOf(Kernel):
    """A kernel made of another one, as a skin on a substrate.

    A subclass has the field of the other kernel and says what it changes. All else is that of the
    substrate, but a closed form, which holds for the very symbol of the substrate.
    """

    substrate_field: ClassVar[str] = "substrate"
    """Name of the field of the other kernel."""

    @property
    def is_isotropic(self) -> bool:
        """Whether the substrate is isotropic."""
        return self._substrate.is_isotropic

    def mean_compliance(self) -> float:
        """Return G(0) [m/Pa] of the substrate."""
        return mean_compliance(self._substrate)

    def branches(self) -> tuple[Branch, ...]:
        """Return the branches of the substrate."""
        return self._substrate.branches()

    def time_span(self) -> tuple[float, float]:
        """Return the span [s] of the substrate."""
        return self._substrate.time_span()

    def without_skin(self) -> Kernel:
        """Return the substrate, without any skin of its own."""
        return self._substrate.without_skin()

    def scaled(self, share: float | OfWave) -> Kernel:
        """Return the same kernel of an elastic substrate ``share`` times as stiff."""
        return self.model_copy(update={self.substrate_field: self._substrate.scaled(share)})

    def depth_to_base(self) -> float:
        """Return the depth [m] of the base under the substrate."""
        return self._substrate.depth_to_base()

    @property
    def _substrate(self) -> Kernel:
        return cast(Kernel, getattr(self, self.substrate_field))


class _Stiffened(KernelOf):
    """An elastic solid whose stiffness is a multiple of another's; not registered."""

    substrate: Kernel
    factor: float | OfWave

    def symbol(self, qx: Array, qy: Array) -> Array:
        symbol, factor = self.substrate.symbol(qx, qy), self.factor
        return symbol / (factor(read_only(np.hypot(qx, qy))) if callable(factor) else factor)

    def mean_compliance(self) -> float:
        factor = float(self.factor(np.zeros(1))[0]) if callable(self.factor) else self.factor
        return mean_compliance(self.substrate) / factor

    def branches(self) -> tuple[Branch, ...]:
        return ()

    def without_skin(self) -> Kernel:
        return self


class _StiffenedClosedForm(_Stiffened):
    """The same of a solid whose Green's function is known in closed form."""

    factor: float

    def greens_function(self, r: Array) -> Array:
        return cast(HasClosedForm, self.substrate).greens_function(r) / self.factor

    def radial_primitive(self, r: Array) -> Array:
        return cast(HasClosedForm, self.substrate).radial_primitive(r) / self.factor


def branches_of(kernel: Kernel) -> tuple[Branch, ...]:
    """Return the branches of a kernel that relaxes; none of one that is elastic."""
    with errors_attributed_to(kernel):
        value = kernel.branches()
        if not value:
            return ()
        value = tuple(Branch(*branch) for branch in value)
    branches = tuple(
        Branch(
            real_number(kernel, "branches() share", b.share),
            b.time if callable(b.time) else real_number(kernel, "branches() time", b.time),
        )
        for b in value
    )
    total = math.fsum(branch.share for branch in branches)
    right = (b.share > 0 and (callable(b.time) or 0 < b.time < math.inf) for b in branches)
    if not all(right) or total > 1 + _ROUNDING:
        raise PluginError(
            f"{component_name(kernel)}: branches() returned {excerpt(branches)}; shares and times "
            "have to be positive and finite, and the shares sum to at most 1"
        )
    return branches


def instantaneous(kernel: Kernel) -> Kernel:
    """Return the elastic kernel of the instantaneous response; an elastic kernel itself.

    It may have a closed form, which a kernel that relaxes need not have.
    """
    return kernel.scaled(1.0) if branches_of(kernel) else kernel
