"""``pellicle check``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .printing import echo, print_json, print_table


def check(
    file: Annotated[Path, typer.Argument(help="TOML file of a run.")],
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Replace a value of the file."),
    ] = None,
    error: Annotated[
        float,
        typer.Option(min=1e-6, max=0.5, help="Allowed relative error of the force."),
    ] = 0.01,
    json: Annotated[bool, typer.Option("--json", help="Print JSON, in SI.")] = False,
) -> None:
    """Check a run file, and estimate its errors and memory from coarser grids."""
    from pellicle import memory
    from pellicle.config.run import Run
    from pellicle.runs.advice import advise
    from pellicle.runs.relaxation import history_arrays
    from pellicle.units import readable

    run = Run.from_toml(file, set_ or ())
    advice = advise(run, error)
    steps = len(run.loading.values)
    needed = memory.estimate(run.grid, steps, run.solver, history_arrays(run))
    if json:
        print_json(
            {
                "steps": [step._asdict() for step in advice.steps],
                "points": advice.points,
                "size": advice.size,
                "memory": needed,
            }
        )
        return
    rows = [
        {
            "step": str(step.step),
            "force": readable(step.force, "N", 3),
            "cells across": f"{step.cells:.0f}",
            "error of force": _share(step.force_error),
            "error of area": _share(step.area_error),
        }
        for step in advice.steps
    ]
    print_table(list(rows[0]), rows)
    nx, ny = run.grid.points
    echo(f"{nx} × {ny} cells need {needed / 1e6:.3g} MB; errors are at most about these")
    if advice.size:
        x, y = (readable(edge, "m", 3) for edge in advice.size)
        echo(f'the contact fits into a smaller domain: grid.size = ["{x}", "{y}"]')
    if advice.points != run.grid.points:
        nx, ny = advice.points
        echo(f"for {100 * error:.2g} % of the force in every step: grid.points = [{nx}, {ny}]")


def _share(value: float) -> str:
    return "no contact" if value != value else f"{100 * value:.2g} %"
