"""Columns of a curve: their roles and units, and the position and force that they give."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping, Set
from contextlib import suppress
from dataclasses import replace
from functools import cache
from numbers import Real
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field, PlainSerializer

from pellicle.arrays import Array
from pellicle.errors import ConfigError, excerpt
from pellicle.schema import Model, nearest
from pellicle.units import Quantity, readable

from .measurement import Measurement, Note, Origin

EXAMPLE = "position [um],force [nN]"
_OF_TIP, _OF_BASE = ("position", "depth"), ("height", "extension")
"""Positions of the indenter, and those from which the deflection must be subtracted."""
_SIGNALS = ("force", "deflection")
"""Names of columns of which one gives the force."""
NAMES = (*_OF_TIP, *_OF_BASE, *_SIGNALS, "time")
"""Names of the columns that are read."""
_CONSTANT = 0.01
_FEWEST = 3
"""Part by which columns, or spring constants, differ by rounding, and rows that may tell."""
UNITS = {"force": "N", "deflection": "mVA", "time": "s"}
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
            f"{excerpt(value)} is not of the form 'Z = extension nm, Defl = deflection nm', or a "
            "table of the same"
        )
    roles: dict[str, tuple[str, str]] = {}
    for column, text in table.items():
        role, *unit = str(text).split() or [""]
        role = role.lower()
        if role not in NAMES:
            raise ConfigError(f"{excerpt(role)} is not a role; {nearest(role, NAMES)}", str(column))
        if role in roles:
            raise ConfigError(f"{roles[role][0]!r} and {column!r} are both {role}")
        roles[role] = str(column), " ".join([role, *unit])
    return dict(roles[role] for role in NAMES if role in roles)


class PerAmpere(float):
    """A sensitivity of a detector whose signal is a current [m/A]; as text, with its unit."""

    def __str__(self) -> str:
        return f"{float(self)!r} m/A"


class _Sensitivity(Quantity):
    """A deflection over a signal in volts or, if its text says so, in amperes."""

    def __call__(self, value: object) -> float:
        if not isinstance(value, (Real, PerAmpere)):
            with suppress(ValueError):
                return PerAmpere(Quantity("m/A", above=0)(value))
        return value if isinstance(value, PerAmpere) else super().__call__(value)


class Calibration(Model):
    """Converts the signal of a cantilever to force and deflection; None if not given."""

    spring_constant: Annotated[float, Quantity("N/m", above=0)] | None = Field(
        None,
        description="of the cantilever, to subtract its bending; it replaces that of a file, and "
        "scales the force",
    )
    sensitivity: Annotated[
        Annotated[float, _Sensitivity("m/V", above=0)] | None,
        PlainSerializer(lambda v: str(v) if isinstance(v, PerAmpere) else v, when_used="json"),
    ] = Field(
        None,
        description="deflection of the cantilever over the signal of its detector; of one in "
        "amperes as a text, such as 60 nm/nA",
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
        '{ "Z" = "extension nm", "Defl" = "deflection nm" }; a unit that the file has is left out',
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

    def contradicts(self, unit: str) -> bool:
        """Return whether a unit is given that is not its own, if it has one."""
        si = si_unit(self.unit)
        factors = {si_unit(u) == si and Quantity(si)(f"1 {u}") for u in (unit, self.unit) if si}
        return bool(unit) and len(factors) > 1

    def takes(self, unit: str) -> bool:
        """Return whether a text is a unit that a column of this name may have."""
        si, name = si_unit(unit), self.name.lower()
        return bool(si) and (name not in NAMES or si in UNITS.get(name, "m"))

    def unit_beside(self, unit: str, path: Path) -> str:
        """Return the ``unit`` that the user gives the column, or else its own.

        One that contradicts its own is a ConfigError.
        """
        if self.contradicts(unit):
            raise ConfigError(
                f"{path}: column {self.name!r} is in {self.unit} by its header, and {unit} was "
                "given for it; leave the unit out of columns, or correct the header"
            )
        return unit or self.unit


Columns = Mapping[str, Column]
"""The columns of one curve by their names in `NAMES`."""


def is_curve(names: Set[str]) -> bool:
    """Return whether columns hold a force or deflection, and a position of some kind."""
    return not names.isdisjoint(_SIGNALS) and not names.isdisjoint((*_OF_TIP, *_OF_BASE))


def missing_parts(columns: Columns, calibration: Calibration) -> list[str]:
    """Return what is missing of a curve: columns or their units, then fields of a calibration."""
    place = next((name for name in (*_OF_TIP, *_OF_BASE) if name in columns), "")
    signals = [name for name in _SIGNALS if name in columns]
    signals = signals if place in _OF_BASE else signals[:1]
    lacks = [] if place else ["a position (or depth, extension, height)"]
    lacks += [] if signals else ["a force (or deflection)"]
    for name in (name for name in (place, *signals, "time") if name in columns):
        unit = columns[name].unit
        if si_unit(unit) not in [*UNITS.get(name, "m")]:
            hint = f" ({excerpt(unit)} is not one of {name})" if unit else ""
            lacks.append(f"the unit of {columns[name].name}{hint}")
    bends = place in _OF_BASE and "deflection" not in signals
    if calibration.spring_constant is None and (bends or signals == ["deflection"]):
        lacks.append("spring_constant")
    deflection = si_unit(columns["deflection"].unit) if "deflection" in signals else "N"
    if calibration.sensitivity is None and deflection in ("V", "A", ""):
        of = {"": "sensitivity if it is in volts", "A": "sensitivity [nm/nA]"}
        lacks.append(of.get(deflection, "sensitivity"))
    return lacks


@np.errstate(over="ignore", invalid="ignore")
def from_columns(columns: Columns, calibration: Calibration) -> Measurement:
    """Return the curve that columns hold, which has no `missing_parts`.

    Force is ``force``, or the spring constant times ``deflection``, which may be in volts or
    amperes if the sensitivity is known.  Position is ``position`` or ``depth``, or else that of the
    cantilever's base, ``extension`` or minus ``height``, less the deflection.  The spring constant
    of the curve is that of its columns, if they contradict the one of the calibration.
    """
    used = []

    def si(name: str) -> Array:
        column, sensitivity = columns[name], calibration.sensitivity
        unit = si_unit(column.unit)
        factor = Quantity(unit)(f"1 {column.unit}")
        if unit in ("V", "A") and sensitivity is not None:
            check_signal(sensitivity, unit)
            used.append(sensitivity)
            factor *= sensitivity
        return column.values * factor

    sizes = {column.name: column.values.size for column in columns.values()}
    if len({*sizes.values()}) > 1:
        raise ConfigError(f"columns differ in length ({sizes}); give a value for each row")
    stiffness = calibration.spring_constant
    name = next(name for name in (*_OF_TIP, *_OF_BASE) if name in columns)
    signal = si_unit(columns["deflection"].unit) if "deflection" in columns else ""
    is_read = signal == "m" or (signal and calibration.sensitivity is not None)
    deflection = si("deflection") if is_read else None
    force = si("force") if "force" in columns else (stiffness or np.nan) * si("deflection")
    position = si(name)
    if deflection is not None and "force" in columns:
        own = _constant_of(force, deflection, name in _OF_BASE)
        if own and stiffness and abs(own / stiffness - 1) > _CONSTANT:
            stiffness = own
    if name in _OF_BASE:
        bend = force / (stiffness or np.nan) if deflection is None else deflection
        position = (position if name == "extension" else -position) - bend
    return Measurement(
        position,
        force,
        name == "depth",
        stiffness=stiffness,
        time=si("time") if "time" in columns else None,
        speed=calibration.speed,
        origin=Origin(
            columns={role: f"{c.name} [{c.unit}]" for role, c in columns.items()},
            sensitivity=used[0] if used else None,
        ),
    )


def _constant_of(force: Array, deflection: Array, is_subtracted: bool) -> float:
    """Return the spring constant [N/m] that two columns hold, or 0 if they are no multiples.

    A constant of either does not count.  If the deflection ``is_subtracted``, one that falls as the
    force grows is a ConfigError.
    """
    rows = np.isfinite(force) & np.isfinite(deflection)
    if np.sum(rows) < _FEWEST:
        return 0.0
    force, deflection = (values[rows] - np.mean(values[rows]) for values in (force, deflection))
    constant = float(force @ deflection / (deflection @ deflection or np.nan))
    if not np.std(force - constant * deflection) < _CONSTANT * np.std(force):
        return 0.0
    if constant < 0 and is_subtracted:
        raise ConfigError(
            "falls as the force grows; change the sign of one of the columns, or leave it out "
            "and give spring_constant",
            "deflection",
        )
    return float(f"{abs(constant):.4g}")


def check_signal(sensitivity: float, unit: str) -> None:
    """Raise unless a sensitivity is that of a signal in volts or in amperes, as its ``unit`` is."""
    if isinstance(sensitivity, PerAmpere) != (unit == "A"):
        of, needed = ("amperes", "nm/V") if unit == "V" else ("volts", "nm/nA")
        raise ConfigError(
            f"is that of a signal in {of}, and this one is in {unit}; give it in {needed}",
            "sensitivity",
        )


def recalibrate(curve: Measurement, calibration: Calibration, *, is_own: bool) -> Measurement:
    """Return a curve with the spring constant of a calibration in place of that of its file.

    The deflection, and so the position, is as it was: the force is scaled.  A sensitivity that is
    given and was not used is a warning or, where the calibration is the file's own, a ConfigError.
    """
    new, old = calibration.spring_constant, curve.stiffness
    if calibration.sensitivity is not None and curve.origin.sensitivity is None:
        text = "is not used: no signal that is read is in volts or amperes"
        if is_own:
            raise ConfigError(f"{text}; leave it out", "sensitivity")
        curve = replace(curve, messages=(*curve.messages, f"the sensitivity {text}"))
    if new is None or old is None or new == old:
        return curve
    text = (
        f"spring constant {readable(new, 'N/m')} in place of the file's {readable(old, 'N/m')}: "
        f"the force is scaled by {new / old:.4g}"
    )
    messages = *curve.messages, Note(text)
    return replace(curve, force=curve.force * (new / old), stiffness=new, messages=messages)


@cache
def si_unit(unit: str) -> str:
    """Return the SI unit of a length, force, voltage, current or time; empty for anything else."""
    for si in "mNVAs" if unit else "":
        with suppress(ValueError):
            Quantity(si)(f"1 {unit}")
            return si
    return ""


def plain(text: str) -> str:
    """Return a text with one kind of µ and of space."""
    return " ".join(unicodedata.normalize("NFKC", text).replace("μ", "µ").split())
