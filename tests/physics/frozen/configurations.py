"""The runs that are frozen: what `pellicle.run` is given, in SI, by a name for each.

They are plain data, so that another version of pellicle can be given the same (`same_as.py`).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

SOLID = {"type": "half_space", "reduced_modulus": 1e4}
SKIN = {"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": 0.05}
BALL = {"type": "paraboloid", "radius": 1e-3}
ROUGH = {
    "type": "self_affine",
    "rms_height": 1e-6,
    "hurst": 0.8,
    "cutoff_wavelength": 6e-5,
    "seed": 1,
}
JKR = {"type": "jkr", "work_of_adhesion": 5e-3}
SOFT = {"type": "linear", "work_of_adhesion": 5e-3, "range": 8e-6}
PRONY = {"type": "viscoelastic", "solid": SOLID, "relaxation": [{"fraction": 0.5, "time": 1.0}]}
POWER_LAW = {
    "type": "viscoelastic",
    "solid": SOLID,
    "power_law": {"exponent": 0.2, "time": 1.0, "shortest": 0.01, "longest": 100.0},
}
YASTREBOV = [{"type": "yastrebov"}]


def free(points: int, size: float = 5e-4) -> dict[str, Any]:
    """Return the table of a domain of which there is one."""
    return {"points": points, "size": size, "boundary": "free"}


def periodic(points: int, size: float = 5e-4) -> dict[str, Any]:
    """Return the table of a domain that repeats."""
    return {"points": points, "size": size, "boundary": "periodic"}


CONFIGURATIONS: dict[str, dict[str, Any]] = {
    "tension, up to the edge": {
        "grid": free(48),
        "kernel": SKIN,
        "indenter": BALL,
        "loading": {"depth": [1e-5, 2e-5, 4e-5, 1e-4], "stiffness": True},
        "corrections": YASTREBOV,
    },
    "prescribed area": {
        "grid": free(32),
        "kernel": SKIN,
        "indenter": BALL,
        "loading": {"contact_area": [1.05e-8, 2e-8]},
    },
    "prescribed radius": {
        "grid": free(48),
        "kernel": SKIN,
        "indenter": {"type": "sphere", "radius": 1e-3},
        "loading": {"contact_radius": [6e-5, 1e-4]},
    },
    "prescribed gap volume": {
        "grid": periodic(32),
        "kernel": SOLID,
        "indenter": ROUGH,
        "loading": {"gap_volume": [3e-13, 1e-13]},
    },
    "prescribed mean plane": {
        "grid": periodic(32),
        "kernel": SOLID,
        "indenter": ROUGH,
        "loading": {"mean_plane_depth": [-2e-6, -1e-6]},
    },
    "rough under pressure": {
        "grid": periodic(48),
        "kernel": SKIN,
        "indenter": ROUGH,
        "loading": {"mean_pressure": [10.0, 100.0], "stiffness": True},
        "corrections": YASTREBOV,
    },
    "rough by conjugate gradients": {
        "grid": free(32),
        "kernel": SKIN,
        "indenter": ROUGH | {"hurst": 0.5, "rms_height": 3e-6},
        "loading": {"force": [1e-6, 1e-5]},
        "solver": {"type": "conjugate_gradient"},
    },
    "three iterations": {
        "grid": free(32),
        "kernel": SKIN,
        "indenter": BALL,
        "loading": {"depth": [2e-5]},
        "solver": {"type": "conjugate_gradient", "max_iterations": 3},
    },
    "sphere on a bonded layer": {
        "grid": periodic(32),
        "kernel": {
            "type": "bonded_layer",
            "reduced_modulus": 1e4,
            "poissons_ratio": 0.5,
            "thickness": 1e-4,
        },
        "indenter": {"type": "shifted", "part": {"type": "sphere", "radius": 1e-3}, "x": 7e-5},
        "loading": {"depth": [5e-6, 1e-5]},
    },
    "cone on coated layers": {
        "grid": free(48),
        "kernel": {
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
        "indenter": {"type": "cone", "half_angle": 1.4},
        "loading": {"force": [1e-5, 5e-5]},
    },
    "rotated quadric under a stretched surface": {
        "grid": free(48),
        "kernel": {
            "type": "gurtin_murdoch",
            "reduced_modulus": 1e4,
            "poissons_ratio": 0.3,
            "surface_stiffness": 1.0,
            "tension": 0.05,
        },
        "indenter": {
            "type": "rotated",
            "part": {"type": "quadric", "radius_x": 1e-3, "radius_y": 2e-3},
            "angle": 0.5,
        },
        "loading": {"depth": [5e-6, 1.2e-5], "stiffness": True},
    },
    "punch under a bending skin": {
        "grid": periodic(32),
        "kernel": {
            "type": "bending_skin",
            "reduced_modulus": 1e4,
            "tension": 0.02,
            "bending": 1e-10,
        },
        "indenter": {"type": "flat_punch", "radius": 1.2e-4},
        "loading": {"depth": [5e-6, 1e-5]},
    },
    "punch on a sliding layer": {
        "grid": free(32),
        "kernel": {
            "type": "frictionless_layer",
            "reduced_modulus": 1e4,
            "poissons_ratio": 0.3,
            "thickness": 5e-5,
        },
        "indenter": {"type": "flat_punch", "radius": 1.2e-4},
        "loading": {"force": [1e-5, 2e-5]},
    },
    "measured heights on a sphere": {
        "grid": {"points": [13, 11], "size": [2.6e-4, 2.2e-4], "boundary": "free"},
        "kernel": {
            "type": "coated",
            "tension": 0.02,
            "substrate": {"type": "winkler", "foundation": 1e8},
        },
        "indenter": {
            "type": "sum",
            "parts": [
                {
                    "type": "heights",
                    "path": str(Path(__file__).parents[2] / "contracts" / "heights.txt"),
                    "unit": 1e-7,
                },
                {"type": "sphere", "radius": 1e-3},
            ],
        },
        "loading": {"depth": [2e-6, 8e-6]},
    },
    "jkr, from jump-in to pull-off": {
        "grid": free(48),
        "kernel": SOLID,
        "indenter": BALL,
        "interaction": JKR,
        "loading": {"depth": [-5e-6, 1e-5, -5e-6, -1e-5, -2e-5, -6e-5]},
    },
    "jkr, pulled by a force": {
        "grid": free(48),
        "kernel": SOLID,
        "indenter": BALL,
        "interaction": JKR,
        "loading": {"force": [2e-5, 0.0, -1e-5, -1e-4], "stiffness": True},
    },
    "jkr, nothing to pull": {
        "grid": free(32),
        "kernel": SOLID,
        "indenter": BALL,
        "interaction": JKR,
        "loading": {"force": [-1e-4]},
    },
    "tension and a cantilever": {
        "grid": free(48),
        "kernel": SKIN,
        "indenter": BALL,
        "interaction": SOFT,
        "loading": {"base_displacement": [3e-5, 0.0, -2e-5], "spring_constant": 2.0},
    },
    "exponential law on waves": {
        "grid": periodic(32),
        "kernel": SOLID,
        "indenter": ROUGH,
        "interaction": {"type": "exponential", "work_of_adhesion": 1e-3, "range": 1e-6},
        "loading": {"mean_pressure": [100.0, 10.0]},
    },
    "dugdale": {
        "grid": free(48),
        "kernel": SOLID,
        "indenter": BALL,
        "interaction": {"type": "dugdale", "work_of_adhesion": 5e-3, "range": 8e-6},
        "loading": {"depth": [1e-5, 0.0, -1e-5]},
    },
    "tension on a solid that relaxes": {
        "grid": free(32),
        "kernel": {"type": "coated", "tension": 0.05, "substrate": PRONY},
        "indenter": BALL,
        "loading": {"depth": [1e-5, 2e-5, 2e-5, 1e-5], "time": [0.0, 1.0, 5.0, 6.0]},
    },
    "power law, held and oscillating": {
        "grid": periodic(32),
        "kernel": POWER_LAW,
        "indenter": BALL,
        "loading": {
            "depth": [
                {"to": 1e-5, "time": 1.0, "num": 3},
                {"hold": 2.0, "num": 2},
                {"amplitude": 5e-7, "frequency": 1.0, "cycles": 2, "num": 4},
            ]
        },
    },
    "sticks and relaxes": {
        "grid": free(32),
        "kernel": PRONY,
        "indenter": BALL,
        "interaction": SOFT,
        "loading": {"depth": [1e-5, 0.0, -1e-5, -1.5e-5], "time": [0.0, 1.0, 5.0, 6.0]},
    },
}

RESUMED = ("tension and a cantilever", "tension on a solid that relaxes", "sticks and relaxes")
"""Those that are also interrupted and resumed."""
