"""The runs of a page, solved one at a time in another thread."""

from __future__ import annotations

import math
import threading
import time
import warnings
from collections.abc import Callable, Mapping
from concurrent.futures import CancelledError
from functools import partial
from typing import Any, Final, NamedTuple

import xarray as xr
from bokeh.document import Document

import pellicle as pl
from pellicle.show import with_rim
from pellicle.units import readable

# Time after which a solve is cancelled if another run waits [s]. A typed tension of 1 MN/m may take
# minutes; but if every solve were cancelled, a contact that sticks would not follow a slider.
_LONGEST_WAIT: Final = 0.5
# Pages take turns: what catches warnings is shared by all threads, so that one run would get the
# warnings of another, or the process lose them for good.
_LOCK: Final = threading.Lock()


class Frame(NamedTuple):
    """The result of a run, in SI, with what is drawn of it."""

    steps: xr.Dataset
    """The load steps, of dimensions (step, x, y)."""
    largest: xr.Dataset
    """The load step with the largest force, of dimensions (x, y)."""
    section: xr.Dataset
    """A cut through its deepest point, along x."""
    line: xr.Dataset
    """The pressure along the cut, up to the rim of contact."""
    remarks: tuple[str, ...]
    """The warnings of the run."""

    def summary(self) -> str:
        """Return the numbers of the run at its largest force, as markup."""
        step, lowest = self.largest, self.steps["force"].values.min()
        radius = math.sqrt(float(step["contact_area"]) / math.pi)
        words = (
            f"At a depth of {readable(float(step['depth']), 'm', 4)}: "
            f"force <b>{readable(float(step['force']), 'N', 4)}</b>, "
            f"contact radius {readable(radius, 'm', 3)} (of a circle of that area)"
        )
        return f"{words}; lowest force {readable(lowest, 'N', 4)}" if lowest < 0 else words


def solve_frame(
    configuration: Mapping[str, Any], progress: bool | Callable[[int, int, float], None] = False
) -> Frame:
    """Return the frame of a run; ``progress`` and exceptions are those of `pellicle.run`."""
    # The outputs that a file names would be written to the current folder.
    run = pl.Run.from_mapping(configuration).model_copy(update={"outputs": None})
    with _LOCK, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        steps = pl.run(run, progress=progress).dataset
        # xarray catches warnings as well, so that the page must not ask it for what it draws.
        largest = steps.isel(step=int(steps["force"].values.argmax()))
        cut = largest.isel(y=int(largest["displacement"].max("x").argmax("y")))
        line = with_rim(cut) if cut["pressure"].values.min() >= 0 else cut
    remarks = tuple(dict.fromkeys(str(entry.message) for entry in caught))
    return Frame(steps, largest, cut, line, remarks)


class Solving:
    """Solves the newest of the runs that are requested, and shows it, until the page is closed."""

    def __init__(
        self, target: Document, show: Callable[[Mapping[str, Any], Frame | Exception], None]
    ) -> None:
        self._target, self._show = target, show
        self._is_working = self._is_closed = False
        self._waiting: Mapping[str, Any] | None = None
        target.on_session_destroyed(self._close)

    def request(self, configuration: Mapping[str, Any]) -> None:
        """Solve a run, once the one that is being solved is finished."""
        if self._is_working:
            self._waiting = configuration
            return
        self._is_working, self._waiting = True, None
        # A daemon does not keep a process alive that is ended during a long solve.
        threading.Thread(target=self._solve, args=(configuration,), daemon=True).start()

    def _close(self, context: object) -> None:
        self._is_closed = True

    def _solve(self, configuration: Mapping[str, Any]) -> None:
        started = time.monotonic()

        def check(*_: object) -> None:
            is_late = self._waiting is not None and time.monotonic() - started > _LONGEST_WAIT
            if self._is_closed or is_late:
                raise CancelledError

        outcome: Frame | Exception
        try:
            outcome = solve_frame(configuration, check)
        except Exception as error:
            # A plugin may raise anything, and the page has to go on.
            outcome = error
        if not self._is_closed:
            self._target.add_next_tick_callback(partial(self._receive, configuration, outcome))

    def _receive(self, configuration: Mapping[str, Any], outcome: Frame | Exception) -> None:
        """Start to solve the run that waits, and show a frame or an error."""
        self._is_working = False
        if self._waiting is not None:
            self.request(self._waiting)
        if not isinstance(outcome, CancelledError):
            self._show(configuration, outcome)
