"""A curve as it is fitted: its rows, and an indenter that has a force curve."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pellicle.components import Executor

from .curve import Curve, Segment, clean
from .likelihood import POINT
from .measured import Measured
from .question import Question
from .simulation import GRID_POINTS, simulate
from .start import BEFORE


def cleaned(measured: Measured, segment: Segment) -> Curve:
    """Return the rows of a measured curve that are fitted.

    Raises
    ------
    ConfigError
        As for `clean`.
    """
    place = measured.position if measured.depth is None else measured.depth
    made = clean(place, measured.force, segment, measured.stiffness)  # type: ignore[arg-type]
    return replace(made, messages=(*measured.messages, *made.messages))


def modelled(
    asked: Question,
    curve: Curve,
    *,
    cache: str | Path | None = None,
    executor: str | Mapping[str, Any] | Executor = "serial",
    grid_points: int = GRID_POINTS,
    progress: bool = False,
) -> Question:
    """Return the question with an indenter that has a force curve, simulated if need be.

    Raises
    ------
    ConfigError, ConvergenceError, StorageError
        As for `simulate`.
    """
    if asked.material is None:
        return asked
    span = float(np.ptp(curve.position))
    held = POINT not in asked.free
    reach = float(curve.position[-1]) - asked.held[POINT] if held else (1 + BEFORE) * span
    made = simulate(
        asked.indenter,
        asked.material,
        # Where nothing reaches contact, the fit itself says so.
        reach if reach > 0 else span,
        cache=None if cache is None else Path(cache),
        executor=executor,
        grid_points=grid_points,
        progress=progress,
    )
    return replace(asked, indenter=made, material=None)
