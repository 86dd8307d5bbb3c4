"""Every registered component keeps the contract of its family, by the kit that strangers use."""

from pellicle import testing
from pellicle.components import FAMILIES, Component


def test_keeps_its_contract(component: Component) -> None:
    """One call checks all that is asked of a component."""
    getattr(testing, f"check_{component.family}")(component)


def test_each_family_has_a_check() -> None:
    """The kit has a function for each family, named after it, and no others."""
    assert set(testing.__all__) == {f"check_{family}" for family in FAMILIES}
