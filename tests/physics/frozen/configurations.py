"""The runs that are frozen: what `pellicle.run` is given, in SI, by a name for each.

They are plain data, so that another version of pellicle can be given the same (`same_as.py`).
"""

from pathlib import Path
from typing import Any


def solid(kind: str = "half_space", **fields: Any) -> dict[str, Any]:
    """Return the table of a kernel of E* = 10 kPa."""
    return {"type": kind, "reduced_modulus": 1e4, **fields}


def relaxing(**law: Any) -> dict[str, Any]:
    """Return the table of a half-space that relaxes."""
    return {"type": "viscoelastic", "solid": solid(), **law}


SOLID, SKIN = solid(), solid("tensed_membrane", tension=0.05)
BALL = {"type": "paraboloid", "radius": 1e-3}
SPHERE = {"type": "sphere", "radius": 1e-3}
PUNCH = {"type": "flat_punch", "radius": 1.2e-4}
ROUGH = {
    "type": "self_affine",
    "rms_height": 1e-6,
    "hurst": 0.8,
    "cutoff_wavelength": 6e-5,
    "seed": 1,
}
JKR = {"type": "jkr", "work_of_adhesion": 5e-3}
SOFT = {"type": "linear", "work_of_adhesion": 5e-3, "range": 8e-6}
PRONY = relaxing(relaxation=[{"fraction": 0.5, "time": 1.0}])
POWER_LAW = relaxing(
    power_law={"exponent": 0.2, "time": 1.0, "shortest": 0.01, "longest": 100.0},
)
YASTREBOV = [{"type": "yastrebov"}]
HEIGHTS = str(Path(__file__).parents[2] / "data" / "heights.txt")


def free(points: int, size: float = 5e-4) -> dict[str, Any]:
    """Return the table of a domain of which there is one."""
    return {"points": points, "size": size, "boundary": "free"}


def periodic(points: int, size: float = 5e-4) -> dict[str, Any]:
    """Return the table of a domain that repeats."""
    return free(points, size) | {"boundary": "periodic"}


def pressed(
    grid: dict[str, Any],
    kernel: dict[str, Any],
    indenter: dict[str, Any],
    loading: dict[str, Any],
    **tables: Any,
) -> dict[str, Any]:
    """Return a run."""
    return {"grid": grid, "kernel": kernel, "indenter": indenter, "loading": loading, **tables}


CONFIGURATIONS: dict[str, dict[str, Any]] = {
    "tension, up to the edge": pressed(
        free(48), SKIN, BALL, {"depth": [1e-5, 2e-5, 4e-5, 1e-4], "stiffness": True},
        corrections=YASTREBOV,
    ),
    "prescribed area": pressed(free(32), SKIN, BALL, {"contact_area": [1.05e-8, 2e-8]}),
    "prescribed radius": pressed(free(48), SKIN, SPHERE, {"contact_radius": [6e-5, 1e-4]}),
    "prescribed gap volume": pressed(periodic(32), SOLID, ROUGH, {"gap_volume": [3e-13, 1e-13]}),
    "prescribed mean plane": pressed(
        periodic(32), SOLID, ROUGH, {"mean_plane_depth": [-2e-6, -1e-6]}
    ),
    "rough under pressure": pressed(
        periodic(48), SKIN, ROUGH, {"mean_pressure": [10.0, 100.0], "stiffness": True},
        corrections=YASTREBOV,
    ),
    "rough by conjugate gradients": pressed(
        free(32), SKIN, ROUGH | {"hurst": 0.5, "rms_height": 3e-6}, {"force": [1e-6, 1e-5]},
        solver={"type": "conjugate_gradient"},
    ),
    "three iterations": pressed(
        free(32), SKIN, BALL, {"depth": [2e-5]},
        solver={"type": "conjugate_gradient", "max_iterations": 3},
    ),
    "sphere on a bonded layer": pressed(
        periodic(32),
        solid("bonded_layer", poissons_ratio=0.5, thickness=1e-4),
        {"type": "shifted", "part": SPHERE, "x": 7e-5},
        {"depth": [5e-6, 1e-5]},
    ),
    "cone on coated layers": pressed(
        free(48),
        {
            "type": "coated",
            "tension": 0.05,
            "bending": 1e-10,
            "substrate": {
                "type": "layered",
                "layers": [
                    {"reduced_modulus": 1e5, "poissons_ratio": 0.3, "thickness": 2e-5},
                    {"reduced_modulus": 1e4, "poissons_ratio": 0.5, "thickness": 1e-4},
                ],
                "substrate": {"reduced_modulus": 1e6, "poissons_ratio": 0.4},
            },
        },
        {"type": "cone", "half_angle": 1.4},
        {"force": [1e-5, 5e-5]},
    ),
    "rotated quadric under a stretched surface": pressed(
        free(48),
        solid("gurtin_murdoch", poissons_ratio=0.3, surface_stiffness=1.0, tension=0.05),
        {
            "type": "rotated",
            "part": {"type": "quadric", "radius_x": 1e-3, "radius_y": 2e-3},
            "angle": 0.5,
        },
        {"depth": [5e-6, 1.2e-5], "stiffness": True},
    ),
    "punch under a bending skin": pressed(
        periodic(32), solid("bending_skin", tension=0.02, bending=1e-10), PUNCH,
        {"depth": [5e-6, 1e-5]},
    ),
    "punch on a sliding layer": pressed(
        free(32), solid("frictionless_layer", poissons_ratio=0.3, thickness=5e-5), PUNCH,
        {"force": [1e-5, 2e-5]},
    ),
    "measured heights on a sphere": pressed(
        {"points": [13, 11], "size": [2.6e-4, 2.2e-4], "boundary": "free"},
        {
            "type": "coated",
            "tension": 0.02,
            "substrate": {"type": "winkler", "foundation": 1e8},
        },
        {"type": "sum", "parts": [{"type": "heights", "path": HEIGHTS, "unit": 1e-7}, SPHERE]},
        {"depth": [2e-6, 8e-6]},
    ),
    "jkr, from jump-in to pull-off": pressed(
        free(48), SOLID, BALL, {"depth": [-5e-6, 1e-5, -5e-6, -1e-5, -2e-5, -6e-5]},
        interaction=JKR,
    ),
    "jkr, pulled by a force": pressed(
        free(48), SOLID, BALL, {"force": [2e-5, 0.0, -1e-5, -1e-4], "stiffness": True},
        interaction=JKR,
    ),
    "jkr, nothing to pull": pressed(free(32), SOLID, BALL, {"force": [-1e-4]}, interaction=JKR),
    "tension and a cantilever": pressed(
        free(48), SKIN, BALL,
        {"base_displacement": [3e-5, 0.0, -2e-5], "spring_constant": 2.0},
        interaction=SOFT,
    ),
    "exponential law on waves": pressed(
        periodic(32), SOLID, ROUGH, {"mean_pressure": [100.0, 10.0]},
        interaction={"type": "exponential", "work_of_adhesion": 1e-3, "range": 1e-6},
    ),
    "dugdale": pressed(
        free(48), SOLID, BALL, {"depth": [1e-5, 0.0, -1e-5]},
        interaction=SOFT | {"type": "dugdale"},
    ),
    "tension on a solid that relaxes": pressed(
        free(32), {"type": "coated", "tension": 0.05, "substrate": PRONY}, BALL,
        {"depth": [1e-5, 2e-5, 2e-5, 1e-5], "time": [0.0, 1.0, 5.0, 6.0]},
    ),
    "power law, held and oscillating": pressed(
        periodic(32),
        POWER_LAW,
        BALL,
        {
            "depth": [
                {"to": 1e-5, "time": 1.0, "num": 3},
                {"hold": 2.0, "num": 2},
                {"amplitude": 5e-7, "frequency": 1.0, "cycles": 2, "num": 4},
            ]
        },
    ),
    "sticks and relaxes": pressed(
        free(32), PRONY, BALL, {"depth": [1e-5, 0.0, -1e-5, -1.5e-5], "time": [0.0, 1.0, 5.0, 6.0]},
        interaction=SOFT,
    ),
}  # fmt: skip

RESUMED = (
    "tension and a cantilever",
    "tension on a solid that relaxes",
    "power law, held and oscillating",
    "sticks and relaxes",
)
"""Those that are also interrupted and resumed."""
