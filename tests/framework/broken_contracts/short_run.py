"""What the tests of broken contracts share: a run and a study of a moment, with parts replaced."""

from __future__ import annotations

from typing import Any

import pellicle as pl
from pellicle.plugins import registry

BOUNDARIES = ("free", "periodic")
GRID: dict[str, Any] = {"points": [12, 10], "size": ["0.24 mm", "0.2 mm"]}


def base(family: str, type_: str) -> Any:
    """Return the class of a built-in component."""
    return registry().components[family][type_].component


def run(**parts: Any) -> pl.Result:
    """Solve two depths of a paraboloid on a half-space, with ``parts`` in place of these."""
    configuration: dict[str, Any] = {
        "grid": GRID,
        "kernel": {"type": "half_space", "reduced_modulus": 1e4},
        "indenter": {"type": "paraboloid", "radius": "1 mm"},
        "loading": {"depth": ["2 um", "4 um"]},
    }
    return pl.run(pl.Run(**configuration | parts), progress=False, threads=1)


def study(executor: Any = None, **parts: Any) -> pl.Study:
    """Return two runs."""
    return pl.Study(
        run={
            "grid": {"points": 16, "size": "0.3 mm"},
            "kernel": {"type": "half_space"},
            "indenter": {"type": "paraboloid", "radius": "1 mm"},
            "loading": {"depth": "5 um"},
            "outputs": [],
            **parts,
        },
        vary={"kernel.reduced_modulus": [1e4, 2e4]},
        executor=executor or {"type": "serial"},
    )
