"""Position and force of a curve, whatever names and units its columns have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from pellicle.arrays import Array, Mask
from pellicle.errors import ConfigError, shown
from pellicle.schema import Model
from pellicle.units import Quantity

from .cleaning import grows
from .measurement import Measurement, Note
from .origin import CurveOrigin
from .roles import EXAMPLE, OF_BASE, POSITIONS, SIGNALS, TIME, ColumnMap, factor, is_voltage

SpringConstant = Annotated[float, Quantity("N/m", above=0)]
"""Spring constant of a cantilever [N/m]."""
Speed = Annotated[float, Quantity("m/s", above=0)]
"""Speed of a cantilever's base, or of the indenter [m/s]."""
Sensitivity = Annotated[float, Quantity("m/V", above=0)]
"""Deflection of a cantilever over the signal of its detector [m/V]."""


class Channel(NamedTuple):
    """Values of a column, of shape (n,), and their unit as text."""

    unit: str
    values: Array
    name: str = ""
    """Its name in the file."""


class Calibration(Model):
    """Converts the signal of a cantilever to force and deflection; None if not given."""

    spring_constant: SpringConstant | None = Field(
        None, description="of the cantilever, to subtract its bending"
    )
    sensitivity: Sensitivity | None = Field(
        None, description="deflection of the cantilever over the signal of its detector"
    )
    speed: Speed | None = Field(
        None, description="constant speed of the base, where a file holds no time"
    )
    columns: ColumnMap = None

    def required_spring_constant(self, purpose: str = "") -> float:
        """Return the spring constant [N/m]; an error tells the purpose if there is one."""
        if self.spring_constant is None:
            raise ConfigError(
                f"is missing{purpose}; give that of the cantilever with its unit, such as "
                "'0.05 N/m' (--spring-constant on the command line)",
                "spring_constant",
            )
        return self.spring_constant


def is_curve(columns: Mapping[str, Channel]) -> bool:
    """Return whether the columns hold a force or deflection, and a position of some kind."""
    return bool(SIGNALS & columns.keys()) and bool(POSITIONS.keys() & columns.keys())


def from_columns(columns: Mapping[str, Channel], calibration: Calibration) -> Measurement:
    """Return the curve that columns with names from `NAMES` hold.

    Force is ``force``, or the spring constant times ``deflection``, which may be in volts if the
    sensitivity is known.  Position is ``position`` or ``depth``, or else that of the cantilever's
    base, ``extension`` or minus ``height``, less the deflection.

    Raises
    ------
    ConfigError
        A column, a unit or a calibration is missing, or a unit measures something else.
    """
    if not SIGNALS & columns.keys():
        listing = ", ".join(columns) or "none that is known"
        raise ConfigError(
            f"has no column force or deflection (columns: {listing}); give a "
            f"header such as {EXAMPLE!r}, or name its columns (--columns on the command line), "
            "which has to name each column that is read"
        )
    names = [name for name in ("position", "depth") if name in columns] or [
        name for name in OF_BASE if name in columns
    ]
    if len(names) != 1:
        problem = (
            f"both {' and '.join(names)}"
            if names
            else "no column position or depth, nor extension or height"
        )
        raise ConfigError(f"has {problem}; give one of them, e.g. {EXAMPLE!r}")
    (name,) = names
    position = factor(name, columns[name].unit) * columns[name].values
    force = (
        factor("force", columns["force"].unit) * columns["force"].values
        if "force" in columns
        else calibration.required_spring_constant()
        * _deflection(columns["deflection"], calibration)
    )
    if name in OF_BASE:
        purpose = (
            f", and column {name} is the {POSITIONS[name]}, from which the deflection must be "
            "subtracted"
        )
        deflection = (
            _deflection(columns["deflection"], calibration)
            if "deflection" in columns
            else force / calibration.required_spring_constant(purpose)
        )
        position = (position if name == "extension" else -position) - deflection
    time = _time(columns, np.isfinite(position) & np.isfinite(force))
    messages: tuple[str, ...] = ()
    if TIME in columns and time is None:
        messages = (unused_time(columns[TIME]),)
        columns = {role: channel for role, channel in columns.items() if role != TIME}
    return Measurement(
        position,
        force,
        name == "depth",
        messages,
        stiffness=calibration.spring_constant,
        time=time,
        speed=calibration.speed,
        origin=CurveOrigin(
            columns={role: f"{c.name or role} [{c.unit}]" for role, c in columns.items()},
            sensitivity=calibration.sensitivity,
        ),
    )


def _time(columns: Mapping[str, Channel], rows: Mask) -> Array | None:
    """Return the time [s]; None where the file holds none that grows in the rows of the curve."""
    if TIME not in columns or not columns[TIME].unit:
        return None
    time = columns[TIME].values
    if time.shape != rows.shape or not grows(time[rows]):
        return None
    return factor(TIME, columns[TIME].unit) * time


def unused_time(column: Channel) -> Note:
    """Return the note on a column of times that do not serve."""
    reason = "falls, stands still or has a row without a number" if column.unit else "has no unit"
    return Note(f"column {column.name or TIME} {reason}, so the curve is taken as one without time")


def _deflection(column: Channel, calibration: Calibration) -> Array:
    if not is_voltage(column.unit):
        return factor("deflection", column.unit) * column.values
    if calibration.sensitivity is None:
        raise ConfigError(
            f"is missing, and column deflection is in {shown(column.unit)}; give it with its unit, "
            "such as '50 nm/V' (--sensitivity on the command line)",
            "sensitivity",
        )
    return calibration.sensitivity * factor("deflection", column.unit) * column.values
