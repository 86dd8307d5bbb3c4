"""Columns of a curve: their roles and units, and the position and force that they give."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping, Set
from contextlib import suppress
from functools import cache
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field

from pellicle.arrays import Array
from pellicle.errors import ConfigError, shown
from pellicle.schema import Model, nearest
from pellicle.units import Quantity

from .measurement import Measurement, Origin

EXAMPLE = "position [um],force [nN]"
_OF_TIP, _OF_BASE = ("position", "depth"), ("height", "extension")
"""Positions of the indenter, and those from which the deflection must be subtracted."""
_SIGNALS = ("force", "deflection")
"""Names of columns of which one gives the force."""
NAMES = (*_OF_TIP, *_OF_BASE, *_SIGNALS, "time")
"""Names of the columns that are read."""
UNITS = {"force": "N", "deflection": "mV", "time": "s"}
"""SI units, each a letter, of columns that are not lengths."""


def column_map(value: object) -> dict[str, str] | None:
    """Return roles of columns such as ``{"Z": "extension nm"}`` in the order of `NAMES`.

    The value is such a table, or a text such as ``"Z = extension nm, Defl = deflection nm"``.
    """
    if value is None:
        return None
    table = value
    if isinstance(value, str):
        entries = [text.rpartition("=") for text in value.split(",")]
        table = {name.strip(): role for name, _, role in entries}
    if not isinstance(table, Mapping) or "" in table:
        raise ConfigError(
            f"{shown(value)} is not of the form 'Z = extension nm, Defl = deflection nm', or a "
            "table of the same"
        )
    found: dict[str, tuple[str, str]] = {}
    for column, text in table.items():
        role, *unit = str(text).split() or [""]
        role = role.lower()
        if role not in NAMES:
            raise ConfigError(f"{shown(role)} is not a role; {nearest(role, NAMES)}", str(column))
        if role in found:
            raise ConfigError(f"{found[role][0]!r} and {column!r} are both {role}")
        found[role] = str(column), " ".join([role, *unit])
    return dict(found[role] for role in NAMES if role in found)


class Calibration(Model):
    """Converts the signal of a cantilever to force and deflection; None if not given."""

    spring_constant: Annotated[float, Quantity("N/m", above=0)] | None = Field(
        None, description="of the cantilever, to subtract its bending"
    )
    sensitivity: Annotated[float, Quantity("m/V", above=0)] | None = Field(
        None, description="deflection of the cantilever over the signal of its detector"
    )
    speed: Annotated[float, Quantity("m/s", above=0)] | None = Field(
        None, description="constant speed of the base, where a file holds no time"
    )
    columns: Annotated[
        dict[str, str] | None,
        BeforeValidator(column_map, json_schema_input_type=dict[str, str] | str | None),
    ] = Field(
        None,
        description="roles of columns by name, by number or by path in the file: "
        '{ "Z" = "extension nm", "Defl" = "deflection nm" }',
    )


class Column(NamedTuple):
    """A column of a file: its head, such as ``position [um]``, and the name and unit in it."""

    text: str
    name: str
    unit: str
    values: Array = np.empty(0)
    """Of shape (n,), in that unit."""

    def is_called(self, name: str) -> bool:
        """Return whether a user who writes ``name`` may mean this column."""
        return plain(name).lower() in (self.text.lower(), self.name.lower())


Columns = Mapping[str, Column]
"""The columns of one curve by their names in `NAMES`."""


def is_curve(names: Set[str]) -> bool:
    """Return whether columns hold a force or deflection, and a position of some kind."""
    return not names.isdisjoint(_SIGNALS) and not names.isdisjoint((*_OF_TIP, *_OF_BASE))


def lacking(columns: Columns, calibration: Calibration) -> list[str]:
    """Return what is missing of a curve: columns or their units, then fields of a calibration."""
    place = next((name for name in (*_OF_TIP, *_OF_BASE) if name in columns), "")
    signals = [name for name in _SIGNALS if name in columns]
    signals = signals if place in _OF_BASE else signals[:1]
    lacks = [] if place else ["a position (or depth, extension, height)"]
    lacks += [] if signals else ["a force (or deflection)"]
    for name in (name for name in (place, *signals, "time") if name in columns):
        unit = columns[name].unit
        if si_unit(unit) not in [*UNITS.get(name, "m")]:
            hint = f" ({shown(unit)} is not one of {name})" if unit else ""
            lacks.append(f"the unit of {columns[name].name}{hint}")
    bends = place in _OF_BASE and "deflection" not in signals
    if calibration.spring_constant is None and (bends or signals == ["deflection"]):
        lacks.append("spring_constant")
    deflection = si_unit(columns["deflection"].unit) if "deflection" in signals else "N"
    if calibration.sensitivity is None and deflection in ("V", ""):
        lacks.append("sensitivity" if deflection else "sensitivity if it is in volts")
    return lacks


@np.errstate(over="ignore", invalid="ignore")
def from_columns(columns: Columns, calibration: Calibration) -> Measurement:
    """Return the curve that columns hold, of which nothing is `lacking`.

    Force is ``force``, or the spring constant times ``deflection``, which may be in volts if the
    sensitivity is known.  Position is ``position`` or ``depth``, or else that of the cantilever's
    base, ``extension`` or minus ``height``, less the deflection.
    """

    def si(name: str) -> Array:
        column = columns[name]
        unit = si_unit(column.unit)
        factor = Quantity(unit)(f"1 {column.unit}")
        factor *= (calibration.sensitivity or 1.0) if unit == "V" else 1.0
        return column.values * factor

    sizes = {column.name: column.values.size for column in columns.values()}
    if len({*sizes.values()}) > 1:
        raise ConfigError(f"columns differ in length ({sizes}); give a value for each row")
    stiffness = calibration.spring_constant or np.nan
    name = next(name for name in (*_OF_TIP, *_OF_BASE) if name in columns)
    force = si("force") if "force" in columns else stiffness * si("deflection")
    position = si(name)
    if name in _OF_BASE:
        deflection = si("deflection") if "deflection" in columns else force / stiffness
        position = (position if name == "extension" else -position) - deflection
    return Measurement(
        position,
        force,
        name == "depth",
        stiffness=calibration.spring_constant,
        time=si("time") if "time" in columns else None,
        speed=calibration.speed,
        origin=Origin(
            columns={role: f"{c.name} [{c.unit}]" for role, c in columns.items()},
            sensitivity=calibration.sensitivity,
        ),
    )


@cache
def si_unit(unit: str) -> str:
    """Return the SI unit of a length, force, voltage or time; empty for anything else."""
    for si in "mNVs" if unit else "":
        with suppress(ValueError):
            Quantity(si)(f"1 {unit}")
            return si
    return ""


def plain(text: str) -> str:
    """Return a text with one kind of µ and of space."""
    return " ".join(unicodedata.normalize("NFKC", text).replace("μ", "µ").split())
