"""The adhesive curve of a path without adhesion, against closed forms."""

from math import inf, pi, sqrt
from typing import Any

import numpy as np
import pytest

from pellicle.errors import ConfigError
from pellicle_axisymmetric import AdhesiveCurve, adhesive_curve

E, R, W = 5.0, 2.0, 0.3
A0 = (W * R**2 / E) ** (1 / 3)
RADII = np.geomspace(0.3, 3, 12) * A0


def hertz(a: Any = RADII, **changed: Any) -> dict[str, Any]:
    """Return the path of a paraboloid on a half-space by its contact radii."""
    path = {
        "depth": a**2 / R,
        "force": 4 * E * a**3 / (3 * R),
        "contact_radius": a,
        "stiffness": 2 * E * a,
    }
    return path | changed


def curve(**changed: Any) -> AdhesiveCurve:
    """Return the adhesive curve of Hertz contact."""
    return adhesive_curve(**{**hertz(), "work_of_adhesion": W} | changed)


def test_on_a_half_space_it_is_the_theory_of_johnson_kendall_and_roberts() -> None:
    """F = 4E*a³/3R − √(8πE*w a³) and δ = a²/R − √(2πaw/E*), the path being power laws."""
    jkr = curve()
    a = jkr.contact_radius
    assert (a[0], a[-1]) == pytest.approx((RADII[0], RADII[-1]), rel=1e-2)
    assert jkr.force == pytest.approx(
        4 * E * a**3 / (3 * R) - np.sqrt(8 * pi * E * W * a**3), rel=1e-8, abs=1e-10
    )
    assert jkr.depth == pytest.approx(a**2 / R - np.sqrt(2 * pi * a * W / E), rel=1e-8, abs=1e-10)


def test_on_separate_springs_it_pulls_off_at_the_force_of_a_rigid_sphere() -> None:
    """On p = Cu a paraboloid pulls off at −2πwR, at a depth of 0."""
    foundation = 7.0
    a = np.geomspace(0.2, 3, 12) * (8 * W / foundation) ** 0.25 * sqrt(R)
    springs = curve(
        depth=a**2 / (2 * R),
        force=pi * foundation * a**4 / (4 * R),
        contact_radius=a,
        stiffness=pi * foundation * a**2,
    )
    pull_off = springs.instability()
    assert pull_off.force == pytest.approx(-2 * pi * W * R, rel=1e-5)
    assert pull_off.depth == pytest.approx(0, abs=1e-3 * sqrt(2 * W / foundation))


def test_points_of_the_curve_are_those_of_johnson_kendall_and_roberts() -> None:
    """Pull-off is −1.5 πwR; no load and the lowest depth are at their radii."""
    jkr = curve()
    pull_off, zero_load, lowest = jkr.instability(), jkr.at_zero_load(), jkr.instability(inf)
    assert pull_off.force == pytest.approx(-1.5 * pi * W * R, rel=1e-5)
    assert pull_off.contact_radius == pytest.approx((9 * pi / 8) ** (1 / 3) * A0, rel=1e-4)
    assert zero_load.force == pytest.approx(0, abs=1e-9)
    assert zero_load.contact_radius == pytest.approx((9 * pi / 2) ** (1 / 3) * A0, rel=1e-4)
    assert lowest.contact_radius == pytest.approx((pi / 8) ** (1 / 3) * A0, rel=1e-4)
    assert lowest.force == pytest.approx(-5 / 6 * pi * W * R, rel=1e-4)


def test_a_cantilever_jumps_where_the_slope_is_minus_its_stiffness() -> None:
    """dF/dδ = −k_c, between pull-off and the lowest depth."""
    jkr = curve()
    spring = E * A0
    a = float(jkr.instability(spring).contact_radius)
    force = 4 * E * a**2 / R - 1.5 * sqrt(8 * pi * E * W * a)
    depth = 2 * a / R - 0.5 * sqrt(2 * pi * W / E / a)
    assert force / depth == pytest.approx(-spring, rel=1e-3)


@pytest.mark.parametrize(("flat", "pinned"), [(0.6, "depth"), (1.5, "both"), (0.2, "")])
def test_the_edge_of_a_flat_end_holds_until_its_punch_lets_go(flat: float, pinned: str) -> None:
    """Without tension δ = a√(a² − b²)/R; the punch lets go at F = −√(8πE*w b³) (Kendall 1971)."""
    b, rise = flat * A0, np.geomspace(0.03, 4, 20) * A0
    a = np.hypot(b, rise)
    force = 2 * E / 3 / R * (2 * a**2 + b**2) * rise
    sticky = curve(**hertz(a, depth=a * rise / R, force=force))
    lowest, pull_off = sticky.instability(inf), sticky.instability()
    fine = np.hypot(b, np.geomspace(1e-4, 10, 20000) * A0)
    rise, retraction = np.sqrt(fine**2 - b**2), np.sqrt(2 * pi * fine * W / E)
    depth = fine * rise / R - retraction
    force = 2 * E / 3 / R * (2 * fine**2 + b**2) * rise - 2 * E * fine * retraction
    assert lowest.depth == pytest.approx(depth.min(), rel=5e-3)
    assert pull_off.force == pytest.approx(force.min(), rel=5e-3)
    assert (lowest.contact_radius == sticky.contact_radius[0]) == bool(pinned)
    assert (pull_off.contact_radius == sticky.contact_radius[0]) == (pinned == "both")


def test_order_and_repetition_of_steps_do_not_matter() -> None:
    """A path there and back has the curve of one way."""
    there_and_back = hertz(np.concatenate([RADII, RADII[-2::-1]]))
    again = curve(**there_and_back)
    for one, other in zip(curve(), again, strict=True):
        assert np.array_equal(one, other)


@pytest.mark.parametrize("scale", [1e-12, 1e6])
def test_scales_change_nothing(scale: float) -> None:
    """Lengths and forces scale, from picometres to megametres."""
    path = {key: value * scale for key, value in hertz().items()}
    path |= {"force": hertz()["force"] * scale**2, "work_of_adhesion": W * scale}
    scaled = adhesive_curve(**path)
    assert scaled.force / scale**2 == pytest.approx(curve().force, rel=1e-8, abs=1e-9)
    assert scaled.instability().depth / scale == pytest.approx(curve().instability().depth)


def test_points_beyond_the_path_are_unknown() -> None:
    """A lowest value at an end of the path is not reported as a minimum."""
    wide = curve(**hertz(np.geomspace(1.6, 2.3, 9) * A0))
    assert np.isnan(wide.instability()).all()
    assert np.isnan(wide.instability(inf)).all()
    assert np.isnan(wide.at_zero_load()).all()


def test_scattered_small_contacts_are_left_out() -> None:
    """Where the radius does not grow with the depth, the curve begins above."""
    force = hertz()["force"].copy()
    force[0] *= 2
    scattered = curve(force=force)
    assert (np.diff(scattered.contact_radius) > 0).all()
    assert scattered.instability().force == pytest.approx(-1.5 * pi * W * R, rel=1e-2)


@pytest.mark.parametrize(
    ("message", "changed"),
    [
        ("work_of_adhesion: must be positive", {"work_of_adhesion": 0.0}),
        ("work_of_adhesion: must be positive", {"work_of_adhesion": -1.0}),
        ("work_of_adhesion: must be positive", {"work_of_adhesion": inf}),
        ("must be positive", {"stiffness": np.zeros(12)}),
        ("must be positive", {"stiffness": np.full(12, np.nan)}),
        ("7 steps that differ in depth; give at least 8", hertz(RADII[:7])),
        ("1 steps that differ in contact radius", {"contact_radius": np.ones(12)}),
        ("does not grow", {"stiffness": 2 * E * RADII[::-1]}),
    ],
)
def test_paths_without_an_adhesive_curve_are_refused(message: str, changed: Any) -> None:
    """Each is refused with what is wrong."""
    with pytest.raises(ConfigError, match=message):
        curve(**changed)


def test_negative_spring_constants_are_refused() -> None:
    """They would hold nothing."""
    with pytest.raises(ConfigError, match="spring_constant"):
        curve().instability(-1.0)
