"""For each rule of kernels: a kernel that breaks it, and only it, by a little."""

from itertools import count
from typing import Any, ClassVar, Literal

import numpy as np
import pytest

from tests.framework.testing.mutants import base, check_base, check_mutant, rules_of

HalfSpace: Any = base("kernel", "half_space")


class Kernel(HalfSpace):
    """Half-space to be broken."""

    type: Literal["broken"] = "broken"


class Scalar(Kernel):
    """Takes one wavenumber at a time."""

    def compliance(self, q: Any) -> Any:
        return np.array([2 / (self.reduced_modulus * float(q.ravel()[0]))])


class Coupled(Kernel):
    """Looks at all wavenumbers for each."""

    def compliance(self, q: Any) -> Any:
        return super().compliance(q) * (1 + 1e-9 * (q / q.max()))


class Single(Kernel):
    """Works in single precision."""

    def compliance(self, q: Any) -> Any:
        return super().compliance(q).astype(np.float32)


class Overwriting(Kernel):
    """Saves memory at its caller's cost."""

    def compliance(self, q: Any) -> Any:
        q *= self.reduced_modulus / 2
        return 1 / q


class Negative(Kernel):
    """Pulls coarse waves up."""

    def compliance(self, q: Any) -> Any:
        return super().compliance(q) - 1e-3


class Overflowing(Kernel):
    """Is NaN for short waves, as sinh/cosh may be."""

    def compliance(self, q: Any) -> Any:
        return np.where(q > 1e11, np.nan, super().compliance(q))


class Growing(Kernel):
    """Yields ever more to short waves."""

    def compliance(self, q: Any) -> Any:
        return super().compliance(q) * (1 + (q * 1e-9) ** 1.1)


class Economical(Kernel):
    """Is content with single precision where there is much to do."""

    def compliance(self, q: Any) -> Any:
        values = super().compliance(q)
        return values if q.size < 300 else values.astype(np.float32).astype(np.float64)


class Wavering(Kernel):
    """Sinks by another amount each time that it is asked."""

    _answers: ClassVar[Any] = count(1)

    def mean_compliance(self) -> float:
        return 1e-6 * int(next(self._answers))


class Half(Kernel):
    """Has one of the two methods of a closed form."""

    radial_primitive: ClassVar[Any] = property(lambda self: (_ for _ in ()).throw(AttributeError()))


class WrongPrimitive(Kernel):
    """Primitive 1 % too large."""

    def radial_primitive(self, r: Any) -> Any:
        return 1.01 * super().radial_primitive(r)


class ShiftedPrimitive(Kernel):
    """Primitive that does not start at 0."""

    def radial_primitive(self, r: Any) -> Any:
        return super().radial_primitive(r) + 1e-12


class WrongForm(Kernel):
    """Closed form 1 % too large, its primitive too."""

    def greens_function(self, r: Any) -> Any:
        return 1.01 * super().greens_function(r)

    def radial_primitive(self, r: Any) -> Any:
        return 1.01 * super().radial_primitive(r)


class Hasty(Kernel):
    """Primitive 0.1 ‰ too large where there are many radii."""

    def radial_primitive(self, r: Any) -> Any:
        return super().radial_primitive(r) * (1 + 1e-4 * (r.size > 1000))


class Complex(Kernel):
    """Yields out of phase."""

    def compliance(self, q: Any) -> Any:
        return super().compliance(q) * (1 + 0.1j)


class Whole(Kernel):
    """Counts in metres per pascal."""

    def compliance(self, q: Any) -> Any:
        return np.ceil(super().compliance(q)).astype(int)


class OverwritingRadii(Kernel):
    """Has a closed form that saves memory at its caller's cost."""

    def greens_function(self, r: Any) -> Any:
        values = super().greens_function(r)
        r *= 2
        return values


class Relaxing(Kernel):
    """Half of it relaxes in a second."""

    def branches(self) -> Any:
        return ((0.5, 1.0),)

    def scaled(self, share: float) -> Any:
        return HalfSpace(reduced_modulus=share * self.reduced_modulus)

    def without_skin(self) -> Any:
        return self


class Overdrawn(Relaxing):
    """Relaxes by more than it has."""

    def branches(self) -> Any:
        return ((0.5, 1.0), (0.6, 2.0))


class Timeless(Relaxing):
    """Relaxes in no time."""

    def branches(self) -> Any:
        return ((0.5, 0.0),)


class Forgetful(Relaxing):
    """Relaxes when it is scaled, too."""

    def scaled(self, share: float) -> Any:
        return Relaxing(reduced_modulus=share * self.reduced_modulus)


class Softer(Relaxing):
    """Is 1 % softer when it is scaled by 1."""

    def scaled(self, share: float) -> Any:
        return super().scaled(0.99 * share)


class StretchedSkin(Relaxing):
    """Scales a skin with the solid."""

    def without_skin(self) -> Any:
        return Relaxing(reduced_modulus=0.5 * self.reduced_modulus)


class Elastic(Relaxing):
    """Is elastic under its skin."""

    def without_skin(self) -> Any:
        return HalfSpace(reduced_modulus=self.reduced_modulus)


KERNELS = {
    Overdrawn: "branches_have_shares_and_times",
    Timeless: "branches_have_shares_and_times",
    Forgetful: "scaled_by_one_is_the_kernel",
    Softer: "scaled_by_one_is_the_kernel",
    StretchedSkin: "scaled_stiffens_the_solid_alone",
    Elastic: "without_skin_has_no_skin",
    Complex: "compliance_is_vectorised",
    Whole: "compliance_is_vectorised",
    OverwritingRadii: "closed_form_leaves_its_argument",
    Scalar: "compliance_is_vectorised",
    Coupled: "compliance_is_vectorised",
    Single: "compliance_is_vectorised",
    Overwriting: "compliance_leaves_its_argument",
    Negative: "compliance_is_positive_and_finite",
    Overflowing: "compliance_is_positive_and_finite",
    Growing: "compliance_does_not_grow_for_short_waves",
    Economical: "periodic_operator_is_the_compliance",
    Wavering: "uniform_pressure_sinks_by_the_mean_compliance",
    Half: "closed_form_is_whole",
    WrongPrimitive: "primitive_is_the_integral_of_the_closed_form",
    ShiftedPrimitive: "primitive_is_the_integral_of_the_closed_form",
    WrongForm: "closed_form_is_the_transform_of_the_compliance",
    Hasty: "free_operator_is_the_transform_of_the_compliance",
}

NO_MUTANT = {"periodic_run_converges", "free_run_converges"}
"""Whole runs: a kernel that fails in them fails in an operator before, as far as we know."""


@pytest.mark.parametrize(
    ("mutant", "rule"), KERNELS.items(), ids=lambda value: getattr(value, "__name__", "")
)
def test_mutant_is_caught(mutant: Any, rule: str) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    check_mutant("kernel", mutant(reduced_modulus=1e4), rule)


def test_what_the_mutants_are_made_of_is_whole() -> None:
    """Without its fault each mutant breaks nothing but that no plugin registers it."""
    check_base("kernel", Kernel(reduced_modulus=1e4))
    check_base("kernel", Relaxing(reduced_modulus=1e4))


def test_each_rule_has_a_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    assert rules_of("kernel", monkeypatch) == set(KERNELS.values()) | NO_MUTANT
