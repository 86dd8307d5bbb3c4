"""One set of fields for each registered type: what the contracts are tested on.

A new component needs an entry here, and a test says so if it has none.  Lengths are those of one
problem: a domain of about 1 mm, a soft solid, indentations of some micrometres.
"""

from pathlib import Path
from typing import Any

EXAMPLES: dict[str, dict[str, dict[str, Any]]] = {
    "kernel": {
        "half_space": {"reduced_modulus": "10 kPa"},
        "tensed_membrane": {"youngs_modulus": 7500.0, "poissons_ratio": 0.5, "tension": "1 N/m"},
        "bending_skin": {"reduced_modulus": 1e4, "tension": "0.1 N/m", "bending": "100 pN*m"},
        "gurtin_murdoch": {
            "youngs_modulus": "9 kPa",
            "poissons_ratio": 0.3,
            "surface_stiffness": "2 N/m",
            "tension": "0.5 N/m",
        },
        "bonded_layer": {
            "reduced_modulus": "10 kPa",
            "poissons_ratio": 0.5,
            "thickness": "0.2 mm",
        },
        "frictionless_layer": {
            "youngs_modulus": "9 kPa",
            "poissons_ratio": 0.3,
            "thickness": "0.1 mm",
        },
        "layered": {
            "layers": [
                {"youngs_modulus": "1 MPa", "poissons_ratio": 0.3, "thickness": "5 um"},
                {"reduced_modulus": "10 kPa", "poissons_ratio": 0.5, "thickness": "0.1 mm"},
            ],
            "substrate": {"youngs_modulus": "100 kPa", "poissons_ratio": 0.4},
        },
        "viscoelastic": {
            "solid": {"type": "half_space", "reduced_modulus": "10 kPa"},
            "relaxation": [
                {"fraction": 0.5, "time": "1 s"},
                {"fraction": 0.3, "time": "1 min"},
            ],
        },
        "winkler": {"foundation": "100 Pa/um"},
        "coated": {
            "tension": "0.2 N/m",
            "substrate": {
                "type": "bonded_layer",
                "youngs_modulus": "10 kPa",
                "poissons_ratio": 0.4,
                "thickness": "0.1 mm",
            },
        },
    },
    "indenter": {
        "paraboloid": {"radius": "1 mm"},
        "quadric": {"radius_x": "1 mm", "radius_y": "2 mm"},
        "sphere": {"radius": "0.4 mm"},
        "cone": {"half_angle": "70 degree"},
        "flat_punch": {"radius": "0.3 mm"},
        "self_affine": {
            "rms_height": "10 um",
            "hurst": 0.7,
            "cutoff_wavelength": "0.4 mm",
            "seed": 3,
        },
        "heights": {"path": str(Path(__file__).with_name("heights.txt")), "unit": "1 um"},
        "topography": {"path": str(Path(__file__).parents[1] / "data" / "patch.x3p"), "fill": 0.01},
        "sum": {
            "parts": [
                {"type": "sphere", "radius": "1 mm"},
                {"type": "quadric", "radius_x": "2 mm", "radius_y": "4 mm"},
            ]
        },
        "scaled": {
            "part": {
                "type": "heights",
                "path": str(Path(__file__).with_name("heights.txt")),
                "unit": "1 um",
            },
            "factor": 0.5,
        },
        "shifted": {
            "part": {"type": "paraboloid", "radius": "1 mm"},
            "x": "0.1 mm",
            "y": "-0.2 mm",
        },
        "rotated": {
            "part": {"type": "quadric", "radius_x": "1 mm", "radius_y": "2 mm"},
            "angle": "30 degree",
        },
    },
    "solver": {"active_set": {"tolerance": 1e-9}, "conjugate_gradient": {"tolerance": 1e-9}},
    "correction": {"yastrebov": {}},
    "interaction": {
        "dugdale": {"work_of_adhesion": "50 mJ/m^2", "range": "2 um"},
        "exponential": {"work_of_adhesion": "50 mJ/m^2", "range": "1 um"},
        "jkr": {"work_of_adhesion": "50 mJ/m^2"},
        "linear": {"work_of_adhesion": "50 mJ/m^2", "strength": "20 kPa"},
    },
    "prescription": {
        "depth": {},
        "mean_plane_depth": {},
        "force": {},
        "mean_pressure": {},
        "contact_area": {},
        "contact_radius": {},
        "base_displacement": {"spring_constant": "0.1 N/m"},
        "gap_volume": {},
    },
    "output": {
        "csv": {},
        "figures": {},
        "curves": {
            "x": "depth / indenter.radius",
            "y": ["contact_area", "contact_area_yastrebov"],
            "series": ["counted", "corrected"],
            "log": ["x"],
            "reference": "axisymmetric",
            "published": [{"label": "by hand", "x": [0.005], "y": [2e-8]}],
            "formats": ["png", "svg"],
        },
        "profiles": {"by": "step", "label": "{depth * 1e6} µm", "reference": "axisymmetric"},
        "maps": {"field": "displacement - depth - gap", "name": "indenter"},
        "html": {"points": 8, "frames": 1},
        "patches": {"connectivity": 8, "by": "step"},
        "distributions": {"bins": 10, "log": ["y"]},
        "spectrum": {"by": "step", "label": "{depth * 1e6} µm"},
        "vtk": {},
        "adhesive_curve": {"work_of_adhesion": "50 mJ/m^2"},
    },
    # The address of dask is that of the fixture dask_address.
    "executor": {
        "serial": {"threads": 1},
        "processes": {"workers": 2},
        "dask": {"address": "tcp://127.0.0.1:8786"},
    },
}
