"""How near the errors that `pellicle check` expects are to the true ones.

python tests/benchmarks/advice.py [--reference 512]

Each case is checked on six grids and solved on them and on a much finer one, which stands for the
truth. Printed are, for each kind of contact and each quantity, the share of true errors below the
expected ones and the median of their ratio; then the same for each step checked alone.
"""

from __future__ import annotations

import argparse
import warnings
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np

import pellicle as pl
from pellicle.arrays import Array
from pellicle.errors import ConfigError
from pellicle.runs.runner import solve
from pellicle_check.advice import advise

POINTS = 40, 64, 100, 144, 192, 256
NAMES = {"force": "force_error", "depth": "depth_error", "contact_area": "area_error"}
DEPTHS = {"depth": ["4 um", "9 um", "15 um", "22 um", "31 um"]}
FORCES = {"force": ["1 uN", "5 uN", "15 uN", "40 uN", "90 uN"]}
SHALLOW = {"depth": ["1 um", "3 um", "6 um"]}
PARABOLOID = {"type": "paraboloid", "radius": "1 mm"}
CONE = {"type": "cone", "half_angle": "80 degree"}
PUNCH = {"type": "flat_punch", "radius": "90 um"}
QUADRIC = {"type": "quadric", "radius_x": "0.4 mm", "radius_y": "1.2 mm"}
HALF_SPACE = {"type": "half_space", "reduced_modulus": "10 kPa"}
LAYER = {
    "type": "bonded_layer",
    "youngs_modulus": "10 kPa",
    "poissons_ratio": 0.45,
    "thickness": "100 um",
}
ROUND_OFF = 1e-7
"""Relative errors below it are those of a prescribed quantity."""


def tensed(tension: str) -> dict[str, Any]:
    """Return a kernel with a tension."""
    return {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": tension}


def rough(seed: int) -> dict[str, Any]:
    """Return a rough surface."""
    return {
        "type": "self_affine",
        "rms_height": "4 um",
        "hurst": 0.8,
        "cutoff_wavelength": "60 um",
        "seed": seed,
    }


def cases() -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the kind of contact and the run, without points, of each case."""
    free, wide, periodic = ("0.45 mm", "free"), ("0.5 mm", "free"), ("0.45 mm", "periodic")
    rows: list[tuple[str, Any, Any, Any, tuple[str, str]]] = [
        *(("smooth", k, PARABOLOID, DEPTHS, free) for k in (HALF_SPACE, tensed("0.1 N/m"))),
        ("smooth", tensed("1 N/m"), PARABOLOID, DEPTHS, free),
        *(("smooth", k, PARABOLOID, FORCES, free) for k in (HALF_SPACE, tensed("0.1 N/m"))),
        *(("smooth", k, CONE, DEPTHS, wide) for k in (HALF_SPACE, tensed("0.1 N/m"))),
        ("smooth", LAYER, {"type": "sphere", "radius": "1 mm"}, DEPTHS, free),
        ("smooth", HALF_SPACE, QUADRIC, DEPTHS, wide),
        *(("smooth", k, PARABOLOID, SHALLOW, periodic) for k in (HALF_SPACE, tensed("0.1 N/m"))),
        *(("punch", k, PUNCH, SHALLOW, free) for k in (HALF_SPACE, tensed("0.1 N/m"))),
    ]
    for seed in (1, 2, 3):
        pressures = {"mean_pressure": ["30 Pa", "100 Pa", "300 Pa"]}
        repeating = "0.5 mm", "periodic"
        rows += [
            ("rough", HALF_SPACE, rough(seed), pressures, repeating),
            ("rough", HALF_SPACE, rough(seed), {"depth": ["4 um", "8 um", "14 um"]}, wide),
            ("rough", tensed("20 mN/m"), rough(seed), SHALLOW, repeating),
        ]
    for kind, kernel, indenter, loading, (size, boundary) in rows:
        grid = {"size": size, "boundary": boundary}
        yield kind, {"grid": grid, "kernel": kernel, "indenter": indenter, "loading": loading}


def with_points(case: dict[str, Any], points: int) -> pl.Run:
    """Return the run of a case."""
    return pl.Run(**{**case, "grid": {**case["grid"], "points": points}, "outputs": []})


def numbers(run: pl.Run) -> dict[str, Array]:
    """Return force, depth and area of each step."""
    data = solve(run).dataset
    return {name: data[name].values for name in NAMES}


def alone(case: dict[str, Any], points: int) -> Iterator[tuple[int, pl.Run]]:
    """Yield each step of a case as a run of its own."""
    ((name, values),) = case["loading"].items()
    for index, value in enumerate(values):
        yield index, with_points({**case, "loading": {name: value}}, points)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reference", type=int, default=512)
    reference = parser.parse_args().reference
    ratios: dict[tuple[str, str, str], list[float]] = defaultdict(list)
    warnings.simplefilter("ignore")
    for kind, case in cases():
        truth = numbers(with_points(case, reference))
        for points in POINTS:
            run = with_points(case, points)
            try:
                together = dict(enumerate(advise(run, 0.01).steps))
                apart = {index: advise(one, 0.01).steps[0] for index, one in alone(case, points)}
            except ConfigError:
                # The coarser grids do not resolve the roughness.
                continue
            solved = numbers(run)
            for how, steps in (("in its run", together), ("alone", apart)):
                for name, error in NAMES.items():
                    scale = np.abs(truth[name])
                    if name == "depth" and how == "in its run":
                        scale = np.full(scale.shape, scale.max())
                    for index, step in steps.items():
                        miss = abs(solved[name][index] - truth[name][index])
                        expected = getattr(step, error)
                        if scale[index] and miss > ROUND_OFF * scale[index] and expected:
                            key = kind, how, name
                            ratios[key].append(expected * scale[index] / miss)
        print(kind, case["kernel"]["type"], case["indenter"]["type"], "done", flush=True)
    for (kind, how, name), values in sorted(ratios.items()):
        known = np.array([value for value in values if np.isfinite(value)])
        held = np.mean(known >= 1)
        low, middle, high = np.quantile(known, (0.1, 0.5, 0.9))
        print(
            f"{kind:7} {how:11} {name:13} held {held:.3f}  expected over true: median "
            f"{middle:.1f}, tenth to nine tenths {low:.1f} to {high:.1f}  ({known.size})"
        )


if __name__ == "__main__":
    main()
