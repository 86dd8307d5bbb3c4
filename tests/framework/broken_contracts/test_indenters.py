"""Indenters that break their contract at work are refused by name, before a result is wrong."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np
import pytest

import pellicle as pl
from tests.framework.broken_contracts.short_run import base, run

Paraboloid: Any = base("indenter", "paraboloid")
Sphere: Any = base("indenter", "sphere")


class Indenter(Paraboloid):
    """Paraboloid that breaks its contract."""

    type: Literal["liar"] = "liar"


class MovesPoints(Indenter):
    """Moves the points that it is asked for."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return the profile of moved points."""
        x -= 1e-6
        return super().profile(x, y)


class ComplexHeights(Indenter):
    """Returns complex heights."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return heights with an imaginary part."""
        return super().profile(x, y) + 0j


class WholeHeights(Indenter):
    """Returns heights rounded to metres."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return whole numbers."""
        return np.trunc(super().profile(x, y)).astype(int)


class HeightsInARow(Indenter):
    """Returns heights in a row."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return a row."""
        return super().profile(x, y).ravel()


class Hovering(Indenter):
    """Has its lowest point 10 µm above the surface."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return heights that nowhere come near 0."""
        return super().profile(x, y) - 1e-5


class HoveringPunch(Indenter):
    """Flat punch 1 nm above the surface."""

    def profile(self, x: Any, y: Any) -> Any:
        """Return −1 nm below the punch, nothing elsewhere."""
        return np.where(x**2 + y**2 < 1e-8, -1e-9, -np.inf)


class HoveringRoughness(Indenter):
    """Fills the domain, 10 µm above the surface."""

    footprint: ClassVar[Any] = "domain"

    def profile(self, x: Any, y: Any) -> Any:
        """Return waves that nowhere come near 0."""
        return 1e-6 * (np.cos(3e4 * x) * np.cos(3e4 * y) - 1) - 1e-5


class Capital(Indenter):
    """Misspells where it ends."""

    footprint: ClassVar[Any] = "Domain"


INDENTERS = {
    MovesPoints: ["changes what it is given", "work on a copy"],
    ComplexHeights: ["profile(x, y) returned an array of complex128"],
    WholeHeights: ["profile(x, y) returned an array of int64"],
    HeightsInARow: ["profile(x, y) returned an array of float64 of shape (120,)", "(12, 10)"],
    Hovering: ["highest value of profile(x, y) is -1.01e-05 m", "0 at the lowest point"],
    HoveringPunch: ["highest value of profile(x, y) is -1e-09 m"],
    HoveringRoughness: ["highest value of profile(x, y) is -1.0"],
    Capital: ["footprint is 'Domain'", "'unbounded' or 'domain'"],
}


@pytest.mark.parametrize("lie", INDENTERS)
def test_an_indenter_that_lies_is_refused(lie: Any) -> None:
    """Whatever is wrong with its profile, the message says what it is and what it has to be."""
    with pytest.raises(pl.PluginError) as error:
        run(indenter=lie(radius=1e-3))
    for part in ["indenter 'liar'", *INDENTERS[lie]]:
        assert part in str(error.value)


CONE = {"type": "cone", "half_angle": "20 degree"}


@pytest.mark.parametrize(
    "indenter",
    [
        {"type": "paraboloid", "radius": "0.1 mm"},
        CONE,
        {"type": "shifted", "x": "9 um", "part": CONE},
        {"type": "shifted", "x": "1 mm", "part": {"type": "paraboloid", "radius": "1 mm"}},
        {"type": "sphere", "radius": "0.1 mm"},
        {"type": "flat_punch", "radius": "0.1 mm"},
    ],
    ids=lambda indenter: indenter["type"],
)
@pytest.mark.parametrize("points", [12, 13, 2, 1, [12, 1]], ids=str)
def test_an_apex_between_the_cells_is_no_lie(indenter: dict[str, Any], points: Any) -> None:
    """However coarse the grid, a profile that is 0 between or beyond its cells is taken."""
    # No pressure at all, so that nothing is refused for another reason.
    result = run(
        indenter=indenter, grid={"points": points, "size": "0.24 mm"}, loading={"force": 0}
    )
    assert result.dataset["force"].item() == 0


@pytest.mark.parametrize(
    "indenter",
    [
        {"type": "sphere", "radius": "15 um"},
        {"type": "self_affine", "rms_height": "1 um", "hurst": 0.5, "cutoff_wavelength": "50 um"},
    ],
    ids=lambda indenter: indenter["type"],
)
def test_summits_as_wide_as_a_cell_are_no_lie(indenter: dict[str, Any]) -> None:
    """A body of four cells, or roughness of few cells, may miss 0 by all its height."""
    grid = {"points": 12, "size": "0.24 mm"}
    assert run(indenter=indenter, grid=grid, loading={"force": 0}).dataset["force"].item() == 0
