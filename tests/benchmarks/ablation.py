"""What each constant of the solver with attraction is worth: applications at half and twice of it.

    python tests/benchmarks/ablation.py [points]

Steps of a paraboloid at four tensions ("closed") and of a rough punch at two, zones of one width.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np
from tables import print_head, print_row

from pellicle.runs.terms import adhesion as widths
from pellicle_plugins.solvers import adhesion, front
from tests.adhesive_paths import rough_path, solved

CONSTANTS: dict[ModuleType, tuple[str, ...]] = {
    adhesion: (
        *("_CONTACT_SHARE", "_MEMORY", "_CHANGES", "_RISE", "_IDLE"),
        *("_LEAST_GAIN", "_GREATEST_GAIN", "_UNSTABLE_GAIN", "_FASTER_SAME"),
    ),
    front: ("STIFFNESS", "LONGEST", "_MOST_CELLS", "_MOST_SHARE"),
}
PATH = [*np.linspace(0.1, 1.3, 7), *np.linspace(1.1, 0.1, 6), -0.2, -0.4]


def applications(points: int) -> list[float]:
    """Return the mean applications of a step of closed contacts and of rough ones."""
    closed = [solved(points, length, PATH) for length in (0.0, 0.1, 1.0, 10.0)]
    rough = [rough_path(points, length) for length in (0.0, 0.1)]
    each = ([path["operator_applications"].mean() for path in paths] for paths in (closed, rough))
    return [float(np.mean(means)) for means in each]


def main() -> None:
    """Print a row for each constant and factor."""
    points = int(sys.argv[1]) if len(sys.argv) > 1 else 128
    setattr(widths, "_WIDER", ())  # noqa: B010 - a constant of another module
    base = applications(points)
    print_head("constant", "value", "closed", "rough")
    print_row("none", "", *(f"{mean:.1f}" for mean in base))
    for module, names in CONSTANTS.items():
        for name in names:
            value = getattr(module, name)
            for factor in (0.5, 2.0):
                changed = type(value)(round(value * factor, 6 * isinstance(value, float)))
                setattr(module, name, changed)
                pairs = zip(applications(points), base, strict=True)
                here = (f"{100 * (now / then - 1):+.0f} %" for now, then in pairs)
                print_row(name.strip("_"), changed, *here)
            setattr(module, name, value)


if __name__ == "__main__":
    main()
