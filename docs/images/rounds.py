"""Draws docs/images/rounds.png: the rounds of a step of a contact that sticks.

python docs/images/rounds.py    (a few seconds)
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.contact import Problem
from pellicle.show import save_figure
from pellicle_plugins.solvers.adhesion import AdhesionSolver
from pellicle_plugins.solvers.adhesive_round import Round

# In units of reduced modulus, radius and work of adhesion.
RUN: dict[str, Any] = {
    "grid": {"points": 64, "size": 5.0},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": 1.0, "tension": 0.5},
    "indenter": {"type": "paraboloid", "radius": 1.0},
    "interaction": {"type": "jkr", "work_of_adhesion": 1.0, "estimate_error": False},
    "loading": {"depth": [0.1, 0.6]},
}


class Rounds(list[Round]):
    """The rounds of the last step of a run, the first of them its start."""

    def __enter__(self) -> Rounds:
        self.begin, self.step = AdhesionSolver.begin, AdhesionSolver.step

        def begin(solver: AdhesionSolver, problem: Problem, start: Any) -> Round:
            self[:] = [self.begin(solver, problem, start)]
            return self[0]

        def step(solver: AdhesionSolver, problem: Problem, state: Round) -> Round:
            self.append(self.step(solver, problem, state))
            return self[-1]

        AdhesionSolver.begin, AdhesionSolver.step = begin, step  # type: ignore[method-assign]
        return self

    def __exit__(self, *_: object) -> None:
        AdhesionSolver.begin, AdhesionSolver.step = self.begin, self.step  # type: ignore[method-assign]


def main() -> None:
    """Run and draw."""
    with Rounds() as rounds:
        print(pl.run(RUN).dataset[["depth", "force", "converged", "iterations"]])
    save_figure(
        lambda figure: draw(figure, rounds),
        Path(__file__).with_name("rounds"),
        ["png"],
        (5.6, 4.4),
    )


def draw(figure: Figure, rounds: Rounds) -> None:
    """Draw residual and gain, and below the cells in contact, over the rounds."""
    above, below = figure.subplots(2, 1, sharex=True)
    number = np.arange(len(rounds))
    above.semilogy(number, [one.residual for one in rounds], marker="o", label="residual")
    above.semilogy(number, [one.gain for one in rounds], "--", marker="s", label="gain of the edge")
    above.legend()
    below.plot(number, [one.on_contact.cells.size for one in rounds], marker="o")
    below.set_ylabel("cells in contact")
    below.set_xlabel("round")


if __name__ == "__main__":
    main()
