"""A force curve that lies is refused where it enters a fit, and its indenter is named."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle_plugins.indenters.of_revolution import Sphere

DEPTH = np.linspace(-1e-6, 2e-6, 60)
FORCE = 1e4 * Sphere(radius=1e-5).force_curve(DEPTH, 1e-7).force


def liar(change: Callable[..., Any]) -> Any:
    """Return a sphere whose force curves are changed, given the depths."""

    class Bead(Sphere):
        """Sphere with other force curves."""

        type: Literal["liar"] = "liar"  # type: ignore[assignment]

        def force_curve(self, depth: Any, length: float) -> Any:
            """Return the force curve, changed."""
            return change(super().force_curve(depth, length), depth)

        def layer_force_curve(self, depth: Any, *solid: float) -> Any:
            """Return the force curve on a layer, changed."""
            return change(super().layer_force_curve(depth, *solid), depth)

    return Bead(radius=1e-5)


@pytest.mark.parametrize(
    "solid", [{}, {"thickness": 1e-5, "poissons_ratio": 0.5}], ids=["half-space", "layer"]
)
@pytest.mark.parametrize(
    "change",
    [
        lambda curve, depth: curve.force,
        lambda curve, depth: curve._replace(force=curve.force[:-1]),
        lambda curve, depth: curve._replace(force=curve.force + 0j),
        lambda curve, depth: curve._replace(force=np.nan * depth),
    ],
    ids=["bare", "short", "complex", "NaN"],
)
def test_a_force_curve_that_lies_is_refused(
    change: Callable[..., Any], solid: dict[str, Any]
) -> None:
    """No modulus is fitted by a force that is none."""
    with pytest.raises(pl.PluginError, match="indenter 'liar': its force curve is "):
        pl.fit(DEPTH, FORCE, indenter=liar(change), rivals=[], **solid)
