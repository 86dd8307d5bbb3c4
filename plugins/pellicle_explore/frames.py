"""Frames of the explorer: depth and force of each load step, and a cut through the contact."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from typing import Any, Final, Self

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Depth, Monitor, Setting
from pellicle.components.calls import branches_of, target_of
from pellicle.config.run import Run
from pellicle.numerics.equilibrium import Equilibrium
from pellicle.numerics.solution import State
from pellicle.runs.compose import compose
from pellicle.runs.runner import solve
from pellicle.runs.steps import solve_step

# Tolerance of a preview: its forces are then right to 2e-5, less than a hundredth of a pixel.
_PREVIEW_TOLERANCE: Final = 1e-4
# Pages take turns: what catches warnings is shared by all threads, so that one run would get the
# warnings of another, or the process lose them for good.
_LOCK: Final = threading.Lock()


@dataclass(frozen=True)
class Frame:
    """The load steps of a run, and a cut through the contact at its largest force, SI."""

    depth: Array
    """Depth at each load step [m], shape (steps,)."""
    force: Array
    """Force at each load step [N], shape (steps,)."""
    states: tuple[State, ...]
    """The surface at each load step."""
    x: Array
    """Positions along x [m], shape (nx,)."""
    surface: Array
    """Height at the largest force along x through the deepest point [m], shape (nx,).

    It is negative below the undeformed surface.
    """
    pressure: Array
    """Pressure there [Pa], shape (nx,)."""
    indenter: Array
    """Height of the indenter there [m], shape (nx,); NaN beside it."""
    cell_area: float
    """Area of a cell [m²]."""
    remarks: tuple[str, ...] = ()
    """Warnings of the run, and the statuses of its load steps other than converged."""
    is_preview: bool = False
    """Whether it is solved to fewer digits than the run asks for, without remarks."""

    @property
    def step(self) -> int:
        """Index of the load step with the largest force."""
        return int(np.argmax(self.force))

    @property
    def contact_area(self) -> float:
        """Contact area at the largest force [m²]."""
        return float(np.count_nonzero(self.states[self.step].contact)) * self.cell_area

    @classmethod
    def of(
        cls,
        run: Run,
        states: Sequence[State],
        force: Sequence[float],
        deepest: tuple[Array, Array],
        **more: Any,
    ) -> Self:
        """Return the frame of solved load steps with these forces [N].

        ``deepest`` is displacement and gap [m] at the largest force, each of the grid's shape.
        """
        displacement, gap = deepest
        row = int(np.argmax(np.max(displacement, axis=0)))
        surface, above = -displacement[:, row], np.maximum(gap[:, row], 0.0)
        return cls(
            depth=np.array([state.depth for state in states]),
            force=np.array(force),
            states=tuple(states),
            x=run.grid.coordinates()[0][:, 0],
            surface=surface,
            pressure=states[int(np.argmax(force))].pressure[:, row],
            indenter=np.where(np.isfinite(above), surface + above, np.nan),
            cell_area=run.grid.cell_area,
            **more,
        )


class _Watched(nullcontext[None]):
    """The context of a run whose monitor calls a function at each iteration."""

    def __init__(self, check: Callable[[], None]) -> None:
        super().__init__()
        self._check = check

    def step(self, index: int) -> Monitor:
        """Return the monitor of a load step."""
        return lambda iteration, residual_ratio: self._check()


def _proceed() -> None:
    """Let a solve go on."""


def solved(document: Mapping[str, Any], check: Callable[[], None] = _proceed) -> Frame:
    """Solve the run that a document describes; ``check`` is called at each iteration.

    Raises
    ------
    ConfigError, PluginError
        The document is not a run, or it cannot be executed.
    """
    run = Run.from_mapping(document)
    with _LOCK, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        data = solve(run, _Watched(check)).dataset
    walls = data["wall_pressure" if "wall_pressure" in data else "pressure"].values
    steps = zip(data["pressure"].values, walls, data["depth"].values.tolist(), strict=True)
    step = int(np.argmax(data["force"].values))
    statuses = [str(status) for status in data["status"].values if status != "converged"]
    return Frame.of(
        run,
        [State(*step) for step in steps],
        data["force"].values.tolist(),
        (data["displacement"].values[step], data["gap"].values[step]),
        remarks=tuple(dict.fromkeys([*statuses, *(str(entry.message) for entry in caught)])),
    )


def preview(
    document: Mapping[str, Any], start: Frame, check: Callable[[], None] = _proceed
) -> Frame | None:
    """Solve a changed run to a few digits, each load step from the same one of ``start``.

    ``check`` is called at each iteration. This takes a fifth to a third of the time of `solved`.
    Returns None if the load steps are not those of ``start``, or if they depend on the ones before
    them, as with an interaction or in a solid that relaxes.

    Raises
    ------
    ConfigError, PluginError
        As for `solved`.
    """
    run = Run.from_mapping(document)
    if run.interaction or branches_of(run.kernel) or len(run.loading.values) != len(start.states):
        return None
    tolerance = max(run.solver.tolerance, _PREVIEW_TOLERANCE)
    loose = run.model_copy(
        update={"solver": run.solver.model_copy(update={"tolerance": tolerance})}
    )
    with _LOCK, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        steps = list(_solve_from(loose, start.states, _Watched(check)))
    deepest = max(steps, key=lambda step: step.force)
    return Frame.of(
        run,
        [step.state for step in steps],
        [step.force for step in steps],
        (deepest.displacement, deepest.gap),
        is_preview=True,
    )


def _solve_from(run: Run, starts: tuple[State, ...], watched: _Watched) -> Iterator[Equilibrium]:
    """Solve each load step of a run from a state of its own."""
    setting = compose(run)
    for index, (value, start) in enumerate(zip(run.loading.values, starts, strict=True)):
        with_state = replace(setting, state=_initial_state(run, setting, value, start))
        yield solve_step(run, with_state, value, watched.step(index)).equilibrium


def _initial_state(run: Run, setting: Setting, value: float, start: State) -> State:
    """Return a state below the indenter, at a depth with the pressure that best closes the gap.

    Without it, a modulus or depth changed by 7 % would leave a start so far off that the solver
    begins on the coarser grid, which takes three times as long.
    """
    pressure = np.where(np.isfinite(setting.profile), start.pressure, 0.0)
    target = target_of(run.loading.prescription, setting, value)
    contact = pressure > 0
    if isinstance(target, Depth) and contact.any():
        goal = (setting.profile + target.value)[contact]
        displacement = setting.operator(pressure)[contact]
        pressure *= max(0.0, float(goal @ displacement / (displacement @ displacement)))
    return State(pressure, pressure, start.depth)
