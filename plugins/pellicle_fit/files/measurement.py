"""One measured curve."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.units import axis_unit
from pellicle_fit.sine import Sine

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Segment = Literal["approach", "approach+hold", "retract", "both"]
"""What is fitted; both: approach, dwell and retract in order of time."""


class Note(str):
    """A message that says what was done; any other is a warning."""


class Site(NamedTuple):
    """Where on the sample a curve was measured [m]."""

    x: float
    y: float


class Origin(NamedTuple):
    """Where a curve comes from; without a file it was given by its numbers."""

    file: str | None = None
    curve: str | None = None
    """Label of the curve in a file that holds several."""
    sha256: str | None = None
    columns: Mapping[str, str] = {}
    """Name and unit of the column in each role."""
    sensitivity: float | None = None
    """Deflection of the cantilever over the signal of its detector [m/V], if it was used."""
    library: str | None = None
    """Package that read the file, if it is not pellicle."""


@dataclass(frozen=True)
class Measurement:
    """One measured curve: position [m] that grows into the solid and force [N], of shape (n,)."""

    position: Array
    force: Array
    is_depth: bool = False
    """Whether the position is a depth, so that the contact point is known to be 0."""
    messages: tuple[str, ...] = ()
    """Rows that were left out, and warnings."""
    stiffness: float | None = None
    """Spring constant of the cantilever [N/m], if its deflection was subtracted from position."""
    time: Array | None = None
    """Time [s] of each row, of shape (n,), increasing; None if it is not known."""
    speed: float | None = None
    """Constant speed [m/s] of the base, from which the time follows if `time` is None."""
    site: Site | None = None
    """Where on the sample it was measured, if it belongs to a force map."""
    origin: Origin = field(default_factory=Origin)
    """Its file, with the hash, the columns and the calibration."""
    pause: Mask | None = None
    """Which rows are of a pause, if the file states its segments."""
    left_out: tuple[int, int] | None = None
    """First and last row of a retraction that was left out of a fit of the approach, from 1."""
    sines: tuple[Sine, ...] = ()
    """What oscillated beside the rows."""
    unloading: Mask | None = None
    """Which rows were taken while the indenter moved out; None until the curve is cleaned."""

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw force against position on ``axes``, or else those of pyplot, and return them."""
        if axes is None:
            from matplotlib import pyplot

            axes = pyplot.gca()
        length, length_unit = axis_unit(self.position, "m")
        scale, unit = axis_unit(self.force, "N")
        axes.plot(np.asarray(self.position) * length, np.asarray(self.force) * scale, ".-")
        label = "depth" if self.is_depth else "position"
        axes.set(xlabel=f"{label} [{length_unit}]", ylabel=f"force [{unit}]")
        return axes


CurvesByLabel = Mapping[str, Callable[[], Measurement]]
"""What reads each curve of a file, by its label, which is empty where there is one."""
