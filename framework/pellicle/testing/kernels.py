"""Contract rules of kernels that need a run or a large grid; the others are `rules.kernels`."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Kernel
from pellicle.components.kernel import instantaneous
from pellicle.components.rules import Case
from pellicle.components.rules.closed_form import displacement_of_centre
from pellicle.errors import ConfigError
from pellicle.grid import Grid
from pellicle.schema.model import walk, with_value
from pellicle.surface.from_kernel import displacement

from .component import check, require_close, rules_of
from .small_runs import solve_small_run

_WIDTH = 1e-4
"""Width w of the Gaussian pressure exp(−r²/2w²) [m]."""
_CASES = [
    Case(Grid(points=[32, 24], size=(size, 0.7 * size), boundary="free"))
    for size in (1e-3, 1e-6, 1e-1)
]


def check_kernel(kernel: Kernel) -> None:
    """Check that a kernel keeps its contract: the rules of kernels, and those of all components.

    They are asked on grids of 1 mm, 1 µm and 10 cm; of a kernel that relaxes ``scaled(1)`` is
    indented.
    """
    check(kernel, Kernel, rules_of(__name__), cases=_CASES)


def runs_converge(kernel: Kernel) -> None:
    """A paraboloid pressed into a periodic and into a free surface converges.

    The free surface is one of kernels that yield equally in all directions.
    """
    for boundary in ("periodic", "free") if kernel.is_isotropic else ("periodic",):
        grid = {"points": 24, "size": "1 mm", "boundary": boundary}
        # A run of a kernel that relaxes would need times.
        solve_small_run(
            grid=grid, kernel=instantaneous(kernel), loading={"depth": ["5 um", "20 um"]}
        )


def numbers_have_derivatives(kernel: Kernel) -> None:
    """The force on a flat punch grows with each number of the kernel as the gradient of a run says.

    It is compared with that of 1 % more and 1 % less, unless one of these is not allowed.
    """
    elastic, boundary = instantaneous(kernel), "free" if kernel.is_isotropic else "periodic"
    run: dict[str, Any] = {
        "grid": {"points": 16, "size": "1 mm", "boundary": boundary},
        "indenter": {"type": "flat_punch", "radius": "0.2 mm"},
        "loading": {"depth": ["10 um"]},
    }
    for path, value, _ in walk({"kernel": elastic}):
        # A number may have no room to either side, or no derivative.
        with suppress(ConfigError):
            if isinstance(value, float) and value:
                field = path.removeprefix("kernel.")
                kernels = [with_value(elastic, field, share * value) for share in (0.99, 1.01)]
                less, more = (solve_small_run(**run, kernel=k)["force"].values for k in kernels)
                result = solve_small_run(**run, kernel=elastic, gradient=[path])
                require_close(
                    result[f"force_by_{path.replace('.', '_')}"].values * value,
                    (more - less) / 0.02,
                    f"the derivative of the force [N] by the logarithm of {path}",
                    relative=1e-3,
                    absolute=1e-5 * float(result["force"][0]),
                )


def free_operator_is_the_transform_of_the_compliance(kernel: Kernel) -> None:
    """On a free grid, a Gaussian pressure displaces its centre by the Hankel integral."""
    if not kernel.is_isotropic:
        return
    grid = Grid(points=255, size=10 * _WIDTH, boundary="free")
    x, y = grid.coordinates()
    pressure = np.exp(-(x**2 + y**2) / (2 * _WIDTH**2))
    springs = kernel.compliance(np.array([1e12]))

    def of_cells(q: Array) -> Array:
        """Return G(q) for a pressure that is uniform in each cell, of side h: times 1 − q²h²/24.

        Springs, the limit of G at q → ∞, respond to the value at the centre of their cell instead.
        """
        compliance = kernel.compliance(q)
        return compliance - (compliance - springs) * (q * grid.spacing[0]) ** 2 / 24

    require_close(
        displacement(pressure, kernel=kernel, grid=grid)[127, 127],
        displacement_of_centre(of_cells, _WIDTH),
        "on a free grid, the central displacement [m] of a Gaussian of 1 Pa, 0.1 mm wide,",
        # The grid ends at five widths, where the Gaussian is 4e-6.
        relative=1e-5,
    )
