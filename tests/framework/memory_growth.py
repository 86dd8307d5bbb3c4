"""Print by how much each kind of run raises the peak memory of a process [bytes], as JSON.

One process loads the library; each kind is measured in a fork of it, so that no kind is measured
in what another has freed, and after a small run, which loads all else that the kind uses.
"""

import gc
import importlib
import json
import os
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any

import pellicle as pl


def main(kinds: dict[str, dict[str, Any]], threads: int) -> None:
    """Measure every kind: a mapping as `pellicle.run` takes it."""
    cache_fonts()
    # Modules that all kinds import are then loaded once.
    first = next(iter(kinds.values()))
    solve(first | small(first), threads)
    growths = {name: growth(kind, threads) for name, kind in kinds.items()}
    sys.stdout.write(json.dumps(growths))


def cache_fonts() -> None:
    """Have a child process write matplotlib's list of fonts, which its first import makes.

    Where the list is missing, making it takes 15 MB, which the kind that draws first would free
    and use again.
    """
    child = os.fork()
    if not child:
        importlib.import_module("matplotlib.font_manager")
        os._exit(0)
    os.waitpid(child, 0)


def growth(kind: dict[str, Any], threads: int) -> int:
    """Return the peak over what is in use after a run on a small grid, in a child process [bytes].

    The peak of the small run does not count: drawing takes as much there, and frees it.
    """
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        solve(kind | small(kind), threads)
        gc.collect()
        before = status("VmRSS")
        assert solve(kind, threads).converged
        os.write(writing, str(status("VmHWM") - before).encode())
        os._exit(0)
    os.close(writing)
    os.waitpid(child, 0)
    with os.fdopen(reading) as pipe:
        return int(pipe.read())


def small(kind: dict[str, Any]) -> dict[str, Any]:
    """Return what is different on a grid of 16 × 16 cells."""
    nx, ny = kind["grid"]["points"]
    changes = {"grid": kind["grid"] | {"points": [min(nx, 16), min(ny, 16)]}}
    if kind["indenter"]["type"] == "self_affine":
        changes["indenter"] = kind["indenter"] | {"cutoff_wavelength": kind["grid"]["size"] / 4}
    return changes


def solve(kind: dict[str, Any], threads: int) -> pl.Result:
    """Run a kind in a folder that is removed."""
    with tempfile.TemporaryDirectory() as folder:
        return pl.run(kind, directory=folder, progress=False, threads=threads)


def status(name: str) -> int:
    """Return a figure of this process [bytes]."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith(name))


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main(json.load(sys.stdin), int(sys.argv[1]))
