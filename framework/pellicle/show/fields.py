"""Pressure and gap of a load step, over the domain and along a line up to the rim."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array, Dataset, Mask
from pellicle.contact.problem import height_scale
from pellicle.results.wording import is_periodic
from pellicle.variables import CORRECTED_AREA

_OUTER, _FITTED, _FEWEST = 2, 4, 16
"""Cells at the rim that are not drawn, those from which the line goes on, and the fewest across."""
_POINTS = 12
_ELLIPTIC = 0.02
"""Share by which the area of a contact may differ from that of its ellipse."""


def without_round_off(step: Dataset) -> Dataset:
    """Return a load step for drawing, with gaps below its tolerance set to 0.

    The tolerance is ``solver.tolerance`` times the length that scales the residuals of the step;
    otherwise full contact would be drawn as a landscape of femtometres. A step under a load has
    no gaps.
    """
    if "gap" not in step:
        return step
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


def default_step(steps: Dataset) -> int:
    """Return the index of the load step of a run that is drawn: the last in contact, else -1."""
    if "contact_area" not in steps:
        return -1
    in_contact = np.flatnonzero(steps["contact_area"].values > 0)
    return int(in_contact[-1]) if in_contact.size else -1


def contact_and_zone(step: Dataset) -> list[Mask]:
    """Return where a load step is in contact, and where a traction acts, each shape (nx, ny)."""
    contact = step["contact"].transpose("x", "y").values
    return [contact, contact | (step["pressure"].transpose("x", "y").values != 0)]


def with_rim(line: Dataset) -> Dataset:
    """Return pressure and numbers along a line of cells of a load step, up to the rim of contact.

    The line has x or y as its only dimension. Where the contact is an ellipse, points at its rim
    take the place of the outermost cells, as `up_to_rim` has it.
    """
    (along,) = {"x", "y"} & set(map(str, line.dims))
    if "contact" not in line:
        return line
    points = line[along].values, line["pressure"].values
    x, pressure = up_to_rim(*points, line["contact"].values, _rim(line, along))
    return (
        line.drop_dims(along)
        .assign_coords({along: (along, x, line[along].attrs)})
        .assign(pressure=(along, pressure, line["pressure"].attrs))
    )


def _rim(line: Dataset, along: str) -> float:
    """Return where an elliptic contact ends on a line through its centre [m]; NaN if it is none.

    The ellipse is that of the cells, scaled to the corrected area if there is one.
    """
    if "semi_major_axis" not in line or float(line["patches"]) != 1:
        return np.nan
    major, minor = float(line["semi_major_axis"]), float(line["semi_minor_axis"])
    counted = float(line["contact_area"])
    if not abs(np.pi * major * minor - counted) <= _ELLIPTIC * counted:
        return np.nan
    angle = np.nan_to_num(float(line["major_axis_angle"])) - (np.pi / 2 if along == "y" else 0.0)
    half, across = (
        float(np.hypot(np.cos(turned) / major, np.sin(turned) / minor)) ** -1
        for turned in (angle, angle - np.pi / 2)
    )
    (axis_across,) = {"x", "y"} - {along}
    areas = [name for name in line.data_vars if str(name).startswith(CORRECTED_AREA)]
    scale = np.sqrt(float(line[areas[0]]) / counted) if areas else 1.0
    return float(scale * half * np.sqrt(max(1.0 - (float(line[axis_across]) / across) ** 2, 0.0)))


def up_to_rim(x: Array, pressure: Array, contact: Mask, rim: float) -> tuple[Array, Array]:
    """Return the points of a line of pressure that ends at the rim of the contact, at ±``rim``.

    How much pressure the two outermost cells carry depends on where the rim passes through them, by
    up to their whole pressure where a tension makes it jump there. In their place the line follows
    p(r) = p₁ + b √(rim² − r²), fitted to the four cells within: Hertz's law of the rim, and beside
    it the jump p₁ ≥ 0 of a tension. Where the contact is not one in the middle of the line and 16
    cells wide, or its pressure grows towards the rim, the line goes through the cells.
    """
    (cells,) = np.nonzero(contact)
    if cells.size < _FEWEST or cells[-1] - cells[0] + 1 != cells.size:
        return x, pressure
    spacing, ends = x[1] - x[0], (-x[cells[0]], x[cells[-1]])
    if not all(abs(end + spacing / 2 - rim) <= spacing for end in ends) or x[-1] <= rim:
        return x, pressure
    within = cells[_OUTER:-_OUTER]
    tails = []
    for fitted in (within[:_FITTED][::-1], within[-_FITTED:]):
        root = np.sqrt(rim**2 - x[fitted] ** 2)
        slope, jump = np.polyfit(root, pressure[fitted], 1)
        if jump < 0:
            slope, jump = (root @ pressure[fitted]) / (root @ root), 0.0
        if slope < 0:
            return x, pressure
        # Evenly spaced in the angle, the points follow the steep end of the root.
        nearest = abs(x[fitted[-1]])
        angle = np.linspace(np.arcsin(nearest / rim), np.pi / 2, _POINTS)[1:]
        tails.append((rim * np.sin(angle), jump + slope * rim * np.cos(angle)))
    (left, before), (right, after) = tails
    # The centre of an outermost cell may lie beyond the rim.
    low, high = ~contact & (x < -rim), ~contact & (x > rim)
    return (
        np.concatenate([x[low], [-rim], -left[::-1], x[within], right, [rim], x[high]]),
        np.concatenate(
            [pressure[low], [0.0], before[::-1], pressure[within], after, [0.0], pressure[high]]
        ),
    )
