"""A force map of 32 × 32 curves: made, fitted by two processes at once, killed, resumed, compared.

The map is a JPK archive that afmformats reads. Its modulus rises threefold in a spot, its tension
grows along x, its height is wavy; some curves are broken, empty or without contact.

    python tests/benchmarks/force_map.py --pixels 32 --folder map
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from pellicle_plugins.indenters.paraboloid import Paraboloid
from tests.plugins.fit import instruments

Array = NDArray[np.float64]
BEAD, SPRING, NOISE, PITCH = Paraboloid(radius=10e-6), 0.05, 0.003, 0.5e-6
NAMES = "reduced_modulus", "tension", "contact_height"


def truth(columns: int, rows: int) -> dict[str, Array]:
    """Return the images that should be found, rows along y."""
    y, x = np.meshgrid(np.arange(rows) / rows, np.arange(columns) / columns, indexing="ij")
    spot = np.exp(-((x - 0.5) ** 2 + (y - 0.4) ** 2) / 0.04)
    return {
        "reduced_modulus": 5e3 * (1 + 2 * spot),
        "tension": 2e-3 * (1 + x),
        "contact_height": -1e-6 * np.sin(3 * x) * y,
    }


def recordings(columns: int, rows: int, points: int = 200) -> list[instruments.Recording]:
    """Return what an instrument sees at each pixel."""
    random, grid = np.random.default_rng(7), instruments.Grid(columns, rows, PITCH)
    depth = np.linspace(-0.5e-6, 1.5e-6, points)
    images = {name: image.ravel() for name, image in truth(columns, rows).items()}
    result = []
    for number in range(columns * rows):
        modulus, tension, height = (float(images[name][number]) for name in NAMES)
        force = modulus * BEAD.force_curve(depth, 2 * tension / modulus).force
        noise = NOISE * force.max() * random.standard_normal(points)
        seen = instruments.record(depth - height, force, noise, SPRING)
        result.append(replace(seen, place=grid.place(number), grid=grid))
    return result


def damaged(curves: list[instruments.Recording]) -> list[int]:
    """Take the contact from some curves, and the numbers from others; return their indices."""
    lost = list(range(5, len(curves), 97))
    for count, number in enumerate(lost):
        force = curves[number].force
        kept = 0.0 * force if count % 2 else force[:0]
        height = curves[number].height[: kept.size]
        curves[number] = replace(curves[number], force=kept, height=height)
    return lost


def command(path: Path, folder: Path, *options: str) -> list[str]:
    """Return the command that fits the map."""
    fit = [sys.executable, "-m", "pellicle", "fit", str(path), "-i", "paraboloid"]
    return [*fit, "--radius", "10 um", "-o", str(folder), "--executor", "processes", *options]


def main() -> None:
    """Make the map, and print what becomes of it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--pixels", type=int, default=32)
    parser.add_argument("--folder", type=Path, default=Path("force-map"))
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    path, once, killed = (given.folder / n for n in ("map.jpk-force-map", "once", "killed"))
    curves = recordings(given.pixels, given.pixels)
    lost = damaged(curves)
    instruments.jpk(path, *curves)
    print(f"{len(curves)} curves, {len(lost)} of them damaged; {path.stat().st_size / 1e6:.1f} MB")

    child = subprocess.Popen(command(path, killed, "--quiet"), start_new_session=True)
    finished = killed / "curves"
    while len(list(finished.glob("*.json"))) < len(curves) // 3 and child.poll() is None:
        time.sleep(0.2)
    second = subprocess.run(
        command(path, killed, "--quiet"), capture_output=True, text=True, check=False
    )
    print(f"second process: exit code {second.returncode}, {second.stderr.strip()}")
    os.killpg(child.pid, signal.SIGKILL)
    child.wait()
    print(f"killed with {len(list(finished.glob('*.json')))} fits finished")
    for folder in (killed, once):
        ended = subprocess.run(command(path, folder), capture_output=True, text=True, check=False)
        lines = [line for line in ended.stdout.splitlines() if "done before" in line]
        print(f"{folder.name}: exit code {ended.returncode}; {'; '.join(lines)}")
    expected = truth(given.pixels, given.pixels)
    for name in NAMES:
        image, resumed = (_image(folder / "maps" / f"map-{name}.tif") for folder in (once, killed))
        low, high = (_image(once / "maps" / f"map-{name}_{end}.tif") for end in ("low", "high"))
        known = np.isfinite(image)
        inside = (np.nan_to_num(low, nan=-np.inf) <= expected[name]) & (
            expected[name] <= np.nan_to_num(high, nan=np.inf)
        )
        error = np.median(np.abs(image - expected[name])[known])
        print(
            f"{name}: resumed {'equal' if np.array_equal(image, resumed, True) else 'DIFFERENT'}, "
            f"{int((~known).sum())} NaN, median error {error:.3g}, "
            f"{100 * inside[known].mean():.1f} % inside the interval"
        )


def _image(path: Path) -> NDArray[np.float32]:
    """Return the numbers of a TIFF, the smallest y first."""
    with Image.open(path) as opened:
        return np.array(opened)[::-1]


if __name__ == "__main__":
    main()
