"""Every registered component keeps the contract of its family, by the kit that strangers use."""

import math

import pytest

import pellicle as pl
from pellicle import testing
from pellicle.components import Component
from pellicle.components.installed import FAMILIES, registry
from pellicle.plugins.registry import family_of
from pellicle.testing.component import kit_of, require_close


def test_keeps_its_contract(component: Component) -> None:
    """One call checks all that is asked of a component."""
    check = kit_of(family_of(type(component)))
    assert check is not None
    check(component)


def test_each_family_has_a_check() -> None:
    """The kit has a function for each family, named after it, and no others."""
    named = {name for name in vars(testing) if name.startswith("check_")}
    assert named == {f"check_{family}" for family in FAMILIES}
    assert all(map(kit_of, registry().families.values()))


def test_a_skin_of_little_tension_keeps_the_contract() -> None:
    """The closed form of an elastocapillary length of 2 pm is right to eight digits only."""
    testing.check_kernel(pl.kernel("tensed_membrane", reduced_modulus="1 GPa", tension="1 mN/m"))


def test_infinite_values_agree_with_their_equals_only() -> None:
    """Infinity is close to itself, and to no number, however large the allowed share."""
    require_close([math.inf, -math.inf, 1.0], [math.inf, -math.inf, 1.0], "the gap", relative=0.1)
    for actual, expected in ((1.0, math.inf), (-math.inf, math.inf), (math.inf, 1.0)):
        with pytest.raises(AssertionError, match=f"the gap is {actual:g}.*expected {expected:g}"):
            require_close([actual], [expected], "the gap", relative=0.1)
    with pytest.raises(AssertionError, match="the gap is nan"):
        require_close([math.nan], [math.nan], "the gap")
