"""Fits answer as they did: forces, χ², noise, minima, ends of intervals, verdicts."""

import pytest

from tests.physics.frozen.fit_curves import CASES
from tests.physics.frozen.fit_layers import LAYERS, differences, fit
from tests.physics.frozen.store import stored

FROZEN = stored("fits")
AT_ONCE = ("elastic",)
AGAIN = "if that is right: python tests/physics/frozen/record.py fits"


@pytest.mark.parametrize("layer", ["forces", "chi_squared", "noise"])
def test_layer(layer: str) -> None:
    """What is computed at given values is as stored."""
    told = differences(layer, FROZEN[layer], dict(LAYERS[layer][0]()))
    assert not told, "\n".join([*told, AGAIN])


@pytest.mark.parametrize(
    "name", [n if n in AT_ONCE else pytest.param(n, marks=pytest.mark.slow) for n in CASES]
)
def test_fit(name: str) -> None:
    """The fit of a curve answers as stored."""
    told = differences("fits", {name: FROZEN["fits"][name]}, {name: fit(name)})
    assert not told, "\n".join([*told, AGAIN])


def test_all_that_is_stored_is_compared() -> None:
    """Each stored fit has its curve."""
    assert FROZEN["fits"].keys() == CASES.keys()
    assert FROZEN.keys() == LAYERS.keys()
