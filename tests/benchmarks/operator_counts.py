"""Operator applications of active_set on every built-in kernel.

    python tests/benchmarks/operator_counts.py --points 64 128 256 512
    python tests/benchmarks/operator_counts.py --cases free

Domain L = 1 mm, E* = 10 kPa, to 1e-8; a row that did not converge says so:
rough   periodic, self-affine (H = 0.8, rms 0.01 L, eight waves along the edge), 300 Pa
free    paraboloid of radius L at a depth of 0.01 L, domain L/2
"""

import argparse
import warnings
from itertools import product
from typing import Any

from tables import print_head, print_row

import pellicle as pl

LENGTH, MODULUS = 1e-3, 1e4
SOLID = {"reduced_modulus": MODULUS}


def layer(base: str, nu: float, thickness: float) -> dict[str, Any]:
    """Return the table of a layer whose thickness is given over L."""
    return SOLID | {"type": base, "poissons_ratio": nu, "thickness": thickness * LENGTH}


def layers(*solids: tuple[float, float, float]) -> dict[str, Any]:
    """Return layers on glass, each as E* over the modulus of the module, ν, thickness over L.

    They are given from the surface down; glass is 10⁶ times as stiff as the module says.
    """
    stack = [
        {"reduced_modulus": e * MODULUS, "poissons_ratio": nu, "thickness": h * LENGTH}
        for e, nu, h in solids
    ]
    glass = {"reduced_modulus": 1e6 * MODULUS, "poissons_ratio": 0.2}
    return {"type": "layered", "layers": stack, "substrate": glass}


def bending(length: float) -> float:
    """Return B for which a wave of q = 1/(length L) feels skin and solid alike."""
    return MODULUS / 2 * (length * LENGTH) ** 3


def surface(tension: float) -> dict[str, Any]:
    """Return the table of surface elasticity, κ_s = 1 N/m."""
    elastic = {"type": "gurtin_murdoch", "poissons_ratio": 0.3, "surface_stiffness": 1.0}
    return SOLID | elastic | {"tension": tension}


def coated(substrate: dict[str, Any], **skin: float) -> dict[str, Any]:
    """Return the table of a skin on a kernel."""
    return {"type": "coated", "substrate": substrate, **skin}


SPRINGS = {"type": "winkler", "foundation": MODULUS / (0.1 * LENGTH)}
KERNELS: dict[str, dict[str, Any]] = {
    "`half_space`": SOLID | {"type": "half_space"},
    "`tensed_membrane`, s = 0.02 L": SOLID | {"type": "tensed_membrane", "tension": 0.1},
    "`gurtin_murdoch`, ν = 0.3": surface(0.0),
    "`gurtin_murdoch`, ν = 0.3, s = 0.02 L": surface(0.1),
    "`bonded_layer`, ν = 0.3, h = 0.02 L": layer("bonded_layer", 0.3, 0.02),
    "`bonded_layer`, ν = 0.3, h = 0.2 L": layer("bonded_layer", 0.3, 0.2),
    "`bonded_layer`, ν = 0.5, h = 0.02 L": layer("bonded_layer", 0.5, 0.02),
    "`bonded_layer`, ν = 0.5, h = 0.2 L": layer("bonded_layer", 0.5, 0.2),
    "`frictionless_layer`, h = 0.02 L": layer("frictionless_layer", 0.3, 0.02),
    "`frictionless_layer`, h = 0.2 L": layer("frictionless_layer", 0.3, 0.2),
    "`layered`: 1, 10, 0.1 E\\*, h = 0.02, 0.05, 0.2 L on glass": layers(
        (1.0, 0.5, 0.02), (10.0, 0.3, 0.05), (0.1, 0.45, 0.2)
    ),
    "`layered`: 100, 1, 0.1 E\\*, h = 0.01, 0.1, 0.2 L on glass": layers(
        (100.0, 0.3, 0.01), (1.0, 0.5, 0.1), (0.1, 0.45, 0.2)
    ),
    "`winkler`": SPRINGS,
    "`coated` `winkler`, τ₀ = 0.1 N/m": coated(SPRINGS, tension=0.1),
    "`coated` layer, ν = 0.3, h = 0.02 L, τ₀ = 1 N/m": coated(
        layer("bonded_layer", 0.3, 0.02), tension=1.0
    ),
    "`coated` layer, ν = 0.5, h = 0.02 L, τ₀ = 1 N/m": coated(
        layer("bonded_layer", 0.5, 0.02), tension=1.0
    ),
    "`bending_skin`, (2B/E\\*)^⅓ = 0.02 L": SOLID
    | {"type": "bending_skin", "bending": bending(0.02)},
    "`bending_skin`, the same and τ₀ = 0.1 N/m": SOLID
    | {"type": "bending_skin", "bending": bending(0.02), "tension": 0.1},
    "`bending_skin`, (2B/E\\*)^⅓ = 0.2 L": SOLID
    | {"type": "bending_skin", "bending": bending(0.2)},
    "`coated` layer, ν = 0.45, h = 0.1 L, (2B/E\\*)^⅓ = 0.05 L": coated(
        layer("bonded_layer", 0.45, 0.1), bending=bending(0.05)
    ),
}


def solve(case: str, kernel: dict[str, Any], points: int) -> Any:
    """Return the only step of a case."""
    rough = {
        "grid": {"points": points, "size": LENGTH, "boundary": "periodic"},
        "indenter": {
            "type": "self_affine",
            "rms_height": LENGTH / 100,
            "hurst": 0.8,
            "cutoff_wavelength": LENGTH / 8,
            "seed": 1,
        },
        "loading": {"mean_pressure": 300.0},
    }
    free = {
        "grid": {"points": points, "size": LENGTH / 2, "boundary": "free"},
        "indenter": {"type": "paraboloid", "radius": LENGTH},
        "loading": {"depth": LENGTH / 100},
    }
    run = pl.Run(kernel=kernel, **{"rough": rough, "free": free}[case])
    return pl.run(run, progress=False, threads=1).dataset.isel(step=0)


def main() -> None:
    """Solve every case and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cases", nargs="+", default=["rough", "free"])
    parser.add_argument("--points", type=int, nargs="+", default=[64, 128, 256, 512])
    options = parser.parse_args()
    warnings.simplefilter("ignore", pl.ConvergenceWarning)
    columns = list(product(options.cases, options.points))
    print_head("kernel", *(f"{case}, N = {points}" for case, points in columns))
    for name, kernel in KERNELS.items():
        steps = [solve(case, kernel, points) for case, points in columns]
        print_row(
            name,
            *(
                f"{step['operator_applications'].item()}"
                f"{'' if step['converged'] else ' not converged'}"
                for step in steps
            ),
        )


if __name__ == "__main__":
    main()
