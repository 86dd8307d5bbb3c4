"""A curve on its own: the parameters that explain it best, and its noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError

from .problem import FitProblem
from .statistics.checks import examine
from .statistics.initial_guess import starts
from .statistics.likelihood import Likelihood, best_minimum
from .statistics.residuals import FailedCheck
from .statistics.shape_check import check_shape


@dataclass(frozen=True)
class Explained:
    """A curve on its own: its likelihood with its noise, and the best parameters."""

    likelihood: Likelihood
    parameters: Array
    freedom: float
    """Degrees of freedom of the noise."""
    noise_from: str
    failed_checks: tuple[FailedCheck, ...]
    messages: tuple[str, ...]
    """What to be careful of, besides the checks."""


def explain(problem: FitProblem) -> Explained:
    """Return the best parameters of a curve, its noise, and the checks that it fails.

    Raises
    ------
    ConfigError
        Nothing explains the curve.
    ConvergenceError
        No search for the best parameters came to an end.
    """
    curve = problem.curve
    largest = float(np.max(np.abs(curve.force)))
    rough = Likelihood(
        curve.position,
        curve.force,
        problem.indenter,  # type: ignore[arg-type]
        largest,
        problem.free,
        curve.stiffness,
    )
    guesses = starts(rough, problem.fixed)
    if not guesses:
        raise ConfigError(
            "is nowhere pushed back as an indenter would be; check signs, indenter and fix", "force"
        )
    minimum = best_minimum(rough, guesses)
    examined = examine(rough, minimum.parameters)
    likelihood = replace(rough, noise=examined.noise)
    scaled = minimum.chi_squared * (largest / examined.noise) ** 2
    notes, failed = check_shape(likelihood, minimum._replace(chi_squared=scaled))
    return Explained(
        likelihood,
        minimum.parameters,
        examined.freedom,
        examined.source,
        (*examined.failed, *failed),
        (*curve.messages, *examined.messages, *notes),
    )
