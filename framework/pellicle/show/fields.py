"""Pressure and gap of a load step, over the domain and along a line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pellicle.arrays import Mask
from pellicle.contact.problem import height_scale
from pellicle.results.wording import is_periodic

if TYPE_CHECKING:
    import xarray as xr


def without_round_off(step: xr.Dataset) -> xr.Dataset:
    """Return a load step for drawing, with gaps below its tolerance set to 0.

    The tolerance is ``solver.tolerance`` times the length that scales the residuals of the step;
    otherwise full contact would be drawn as a landscape of femtometres.
    """
    gap, depth = step["gap"].values, float(step["depth"])
    # A step that failed may have infinite values of both signs.
    with np.errstate(invalid="ignore"):
        profile = step["displacement"].values - depth - gap
        # A layer far thicker than its period sinks by much more than the heights.
        if is_periodic(step):
            depth -= float(step["displacement"].mean())
    closed = np.abs(gap) <= step.attrs["tolerance"] * height_scale(
        profile, step["contact"].values, depth
    )
    return step.assign(gap=(step["gap"].dims, np.where(closed, 0.0, gap), step["gap"].attrs))


def default_step(steps: xr.Dataset) -> int:
    """Return the index of the load step of a run that is drawn: the last in contact, else -1."""
    in_contact = np.flatnonzero(steps["contact_area"].values > 0)
    return int(in_contact[-1]) if in_contact.size else -1


def contact_and_zone(step: xr.Dataset) -> list[Mask]:
    """Return where a load step is in contact, and where a traction acts, each shape (nx, ny)."""
    contact = step["contact"].transpose("x", "y").values
    return [contact, contact | (step["pressure"].transpose("x", "y").values != 0)]
