"""What fits cost: master curves, one curve, and a folder of curves as a user fits it.

Run it: ``python tests/benchmarks/fit.py [curves [workers]]``.  Times of one curve are those of the
processor; a folder is timed by a clock, files in and table out.
"""

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

import pellicle as pl
from pellicle.components import HasForceCurve

_RADIUS, _MODULUS, _LENGTH = 5e-6, 2e3, 3e-6
_POINTS, _NOISE, _BEAD = 2000, 0.005, 10e-6
"""Of the curves in a folder: rows, noise over the largest force, and the radius [m]."""


def _seconds(work: Callable[[], object]) -> float:
    began = process_time()
    work()
    return process_time() - began


def _shape(type_: str, radius: float) -> HasForceCurve:
    indenter = pl.indenter(type_, radius=radius)
    assert isinstance(indenter, HasForceCurve)
    return indenter


def _with_noise(force: NDArray[np.float64], random: np.random.Generator) -> NDArray[np.float64]:
    noise = random.standard_normal(force.size)
    return np.asarray(force + _NOISE * force.max() * noise)


def one_curve(type_: str, curves: int) -> None:
    """Print what the master curve of a shape and fits of single curves take."""
    indenter, at = _shape(type_, _RADIUS), np.array([1e-6])
    first = _seconds(lambda: indenter.force_curve(at, _LENGTH))
    print(f"{type_}: master curve loaded in {1e3 * first:.1f} ms")
    for points in (60, _POINTS):
        depth = np.linspace(-0.5e-6, 1.5e-6, points)
        force = _MODULUS * indenter.force_curve(depth, _LENGTH).force
        times = []
        for seed in range(curves):
            measured = _with_noise(force, np.random.default_rng(seed))
            began = process_time()
            pl.fit(depth + 1e-6, measured, indenter=indenter)
            times.append(process_time() - began)
        print(
            f"  {points} points: {np.median(times):.2f} s a fit, {max(times):.2f} s the "
            f"longest, {sum(times):.1f} s for {curves} curves"
        )


def write(folder: Path, curves: int) -> None:
    """Write random curves, modulus and s/R log-uniform, each with its own contact point."""
    random, indenter = np.random.default_rng(2), _shape("paraboloid", _BEAD)
    depth = np.linspace(-0.3, 1.0, _POINTS) * 0.3 * _BEAD
    for number in range(curves):
        modulus = np.exp(random.uniform(np.log(500), np.log(20e3)))
        ratio = np.exp(random.uniform(np.log(0.03), np.log(1.0)))
        force = _with_noise(modulus * indenter.force_curve(depth, ratio * _BEAD).force, random)
        position = depth + random.uniform(-1, 1) * _BEAD
        np.savetxt(
            folder / f"{number:04d}.csv",
            np.column_stack([position * 1e6, force * 1e9]),
            delimiter=",",
            header="position [um],force [nN]",
            comments="",
        )


def main() -> None:
    """Print the times."""
    given = [int(text) for text in sys.argv[1:]]
    curves, workers = [*given, *(100, 2)[len(given) :]]
    for type_ in ("paraboloid", "sphere"):
        one_curve(type_, curves)
    options: dict[str, Any] = {"indenter": "paraboloid", "radius": _BEAD, "progress": False}
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "curves"
        folder.mkdir()
        write(folder, curves)
        for executor in ({"type": "serial"}, {"type": "processes", "workers": workers}):
            directory = Path(temporary) / str(executor["type"])
            began = perf_counter()
            table = pl.fit_many(folder, executor=executor, directory=directory, **options)
            seconds = perf_counter() - began
            fitted = int((table["status"] == "fitted").sum())
            print(f"{executor}: {fitted} of {curves} curves of {_POINTS} points in {seconds:.1f} s")


if __name__ == "__main__":
    main()
