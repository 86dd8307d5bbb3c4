"""Draws docs/images/applications.png: operator applications of both solvers against N.

python docs/images/applications.py    (about three minutes on one core)
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.contact import Problem
from pellicle.show import save_figure
from pellicle.show.figure_style import MARKERS
from pellicle.surface import operator_of

POINTS = {"conjugate_gradient": (64, 128, 256, 512), "active_set": (64, 128, 256, 512, 1024)}
TENSIONS = {0.0: "no tension", 0.02: "s = 0.02 L", 1.0: "s = L"}


def applications(solver: str, points: int, s: float) -> int:
    """Return the operator applications on the finest grid for a rough periodic contact."""
    grid = pl.Grid(points=points, size=1.0, boundary="periodic")
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=s / 2)
    surface = pl.indenter(
        "self_affine", rms_height=0.01, hurst=0.8, cutoff_wavelength=16 / points, seed=1
    )
    profile = surface.profile(*grid.coordinates())
    slope = np.hypot(*np.gradient(profile, 1 / points))
    force = 0.1 * float(np.sqrt(np.mean(slope**2)))
    problem = Problem(grid, operator_of(kernel, grid), profile, pl.Force(force))
    pl.solver(solver, tolerance=1e-6).solve(problem, None, lambda iteration, excess: None)
    return problem.operator.applications


def main() -> None:
    """Measure and draw."""
    counts = {
        (solver, s): [applications(solver, points, s) for points in POINTS[solver]]
        for solver in POINTS
        for s in TENSIONS
    }
    print(counts)
    save_figure(
        lambda figure: draw(figure, counts),
        Path(__file__).with_name("applications"),
        ["png"],
        (5.6, 3.8),
    )


def draw(figure: Figure, counts: dict[tuple[str, float], list[int]]) -> None:
    """Draw the counts: a colour and a marker for each tension, dashes for conjugate gradients."""
    axes = figure.add_subplot()
    for (solver, s), values in counts.items():
        number = list(TENSIONS).index(s)
        axes.loglog(
            POINTS[solver],
            values,
            "--" if solver == "conjugate_gradient" else "-",
            marker=MARKERS[number],
            markerfacecolor="white",
            color=f"C{number}",
            label=f"{solver}, {TENSIONS[s]}",
        )
    ticks = POINTS["active_set"]
    axes.set_xticks(ticks, [str(points) for points in ticks])
    axes.minorticks_off()
    axes.set(xlabel="cells along an edge, N", ylabel="operator applications, finest grid")
    axes.grid(alpha=0.3)
    axes.set_ylim(8, 2000)
    axes.legend(fontsize="small", loc="upper left")


if __name__ == "__main__":
    main()
