"""Two deformable bodies pressed together, each with its own surface."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from pellicle.arrays import Array
from pellicle.components import Branch, FromRegistry, Kernel, OfWave, have_equal_branches
from pellicle.surface import mean_compliance


class Pair(Kernel):
    """Two bodies that both yield: the displacements of their surfaces add (Johnson 1985).

    The indenter is the difference of their undeformed surfaces. `displacement` and `depth` are
    sums over both, and the pressure on both is one.
    """

    type: Literal["pair"] = "pair"
    examples = (
        {
            "first": {"type": "tensed_membrane", "reduced_modulus": "1 kPa", "tension": "1 mN/m"},
            "second": {"type": "half_space", "reduced_modulus": "10 kPa"},
        },
    )
    first: Annotated[Kernel, FromRegistry()] = Field(
        description="the kernel of one body: a table with type"
    )
    second: Annotated[Kernel, FromRegistry()] = Field(
        description="the kernel of the other body: a table with type"
    )

    @property
    def is_isotropic(self) -> bool:
        """Whether both are."""
        return self.first.is_isotropic and self.second.is_isotropic

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return G(q) = G₁ + G₂ [m/Pa]; Johnson 1985, section 4.1."""
        return self.first.symbol(qx, qy) + self.second.symbol(qx, qy)

    @property
    def greens_function(self) -> Callable[[Array], Array]:
        """G(r) = G₁ + G₂ [m/N]; it exists if both have one."""
        return self._added("greens_function")

    @property
    def radial_primitive(self) -> Callable[[Array], Array]:
        """∫₀^r G r dr [m³/N] of both."""
        return self._added("radial_primitive")

    def _added(self, name: str) -> Callable[[Array], Array]:
        first, second = (getattr(kernel, name) for kernel in (self.first, self.second))
        return lambda r: first(r) + second(r)

    def mean_compliance(self) -> float:
        """Return G(0) [m/Pa] of both."""
        return mean_compliance(self.first) + mean_compliance(self.second)

    def branches(self) -> tuple[Branch, ...]:
        """Return the branches, which both bodies have alike."""
        return self.first.branches()

    def time_span(self) -> tuple[float, float]:
        """Return the times at which the branches of both hold."""
        starts, ends = zip(self.first.time_span(), self.second.time_span(), strict=True)
        return max(starts), min(ends)

    def scaled(self, share: float | OfWave) -> Kernel:
        """Return the elastic kernel of both bodies ``share`` times as stiff."""
        if not self.branches():
            return super().scaled(share)
        return Pair.model_construct(
            first=self.first.scaled(share), second=self.second.scaled(share)
        )

    def depth_to_base(self) -> float:
        """Return the depth [m] of the nearer base."""
        return min(self.first.depth_to_base(), self.second.depth_to_base())

    @model_validator(mode="after")
    def _check_relaxation(self) -> Self:
        bodies = self.first, self.second
        if not have_equal_branches(self.first.branches(), self.second.branches()):
            raise ValueError(
                "the bodies relax differently, and then their sum has no branches of its own; give "
                "both the same fractions and times, or none"
            )
        if self.branches() and any(body.without_skin() != body for body in bodies):
            raise ValueError(
                "a body relaxes under a skin, which does not, so the sum has no branches of its "
                "own; give both bodies without a skin, or elastic ones"
            )
        return self
