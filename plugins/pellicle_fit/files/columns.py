"""Columns of a curve: their roles and units, and the position and force that they give."""

from __future__ import annotations

import re
from collections.abc import Mapping, Set
from contextlib import suppress
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field

from pellicle.arrays import Array
from pellicle.errors import ConfigError, shown
from pellicle.schema import Model, nearest
from pellicle.units import Quantity

from .measurement import Measurement, Note, Origin, grows

EXAMPLE = "position [um],force [nN]"
_OF_TIP, _OF_BASE = ("position", "depth"), ("height", "extension")
"""Positions of the indenter, and those from which the deflection must be subtracted."""
_SIGNALS = ("force", "deflection")
"""Names of columns of which one gives the force."""
NAMES = (*_OF_TIP, *_OF_BASE, *_SIGNALS, "time")
"""Names of the columns that are read."""
LABEL = "curve"
"""Name of the column that tells the curves of one table apart."""
_UNITS = {"force": ("N", "nN"), "time": ("s", "ms")}
"""SI units of columns that are not lengths, and those of the examples in messages."""


def column_map(value: object) -> dict[str, str] | None:
    """Return roles of columns such as ``{"Z": "extension nm"}`` in the order of `NAMES`.

    The value is such a table, or a text such as ``"Z = extension nm, Defl = deflection nm"``.
    """
    if value is None:
        return None
    table = value
    if isinstance(value, str):
        texts = [text for text in re.findall(r'(?:"[^"]*"|[^,"])+', value) if text.strip()]
        entries = [text.rpartition("=") for text in texts]
        table = {name.strip().strip('"'): role for name, _, role in entries} or None
    if not isinstance(table, Mapping) or "" in table:
        raise ConfigError(
            f"{shown(value)} is not of the form 'Z = extension nm, Defl = deflection nm', or a "
            "table of the same"
        )
    roles = (*NAMES, LABEL)
    by_role: dict[str, tuple[str, str]] = {}
    for column, text in table.items():
        name, _, unit = str(text).strip().partition(" ")
        role, unit = name.lower(), unit.strip()
        if role not in roles:
            raise ConfigError(f"{shown(role)} is not a role; {nearest(role, roles)}", str(column))
        if role in by_role:
            raise ConfigError(f"{by_role[role][0]!r} and {column!r} are both {role}")
        if role == LABEL:
            unit = ""
        elif unit:
            _factor(role, unit)
        by_role[role] = str(column), f"{role} {unit}".strip()
    return dict(by_role[role] for role in roles if role in by_role)


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

    def required_spring_constant(self, purpose: str = "") -> float:
        """Return the spring constant [N/m]; an error tells the purpose if there is one."""
        if self.spring_constant is None:
            raise ConfigError(
                f"is missing{purpose}; give that of the cantilever with its unit, such as "
                "'0.05 N/m' (--spring-constant on the command line)",
                "spring_constant",
            )
        return self.spring_constant


class Channel(NamedTuple):
    """Values of a column, of shape (n,), their unit as text, and its name in the file."""

    unit: str
    values: Array
    name: str = ""


Columns = Mapping[str, Channel]
"""The columns of one curve by their names in `NAMES`."""


def is_curve(names: Set[str]) -> bool:
    """Return whether columns hold a force or deflection, and a position of some kind."""
    return not names.isdisjoint(_SIGNALS) and not names.isdisjoint((*_OF_TIP, *_OF_BASE))


def from_columns(columns: Columns, calibration: Calibration) -> Measurement:
    """Return the curve that columns hold.

    Force is ``force``, or the spring constant times ``deflection``, which may be in volts if the
    sensitivity is known.  Position is ``position`` or ``depth``, or else that of the cantilever's
    base, ``extension`` or minus ``height``, less the deflection.
    """
    if columns.keys().isdisjoint(_SIGNALS):
        listing = ", ".join(columns) or "none that is known"
        raise ConfigError(
            f"has no column force or deflection (columns: {listing}); give a "
            f"header such as {EXAMPLE!r}, or name its columns (--columns on the command line), "
            "which has to name each column that is read"
        )
    of_tip, of_base = ([name for name in kind if name in columns] for kind in (_OF_TIP, _OF_BASE))
    names = of_tip or of_base
    if len(names) != 1:
        both = f"both {' and '.join(names)}"
        problem = both if names else "no column position or depth, nor extension or height"
        raise ConfigError(f"has {problem}; give one of them, e.g. {EXAMPLE!r}")

    def si(name: str) -> Array:
        factor = _factor(name, columns[name].unit)
        if si_unit(columns[name].unit) == "V":
            if calibration.sensitivity is None:
                raise ConfigError(
                    f"is missing, and column deflection is in {shown(columns[name].unit)}; give it "
                    "with its unit, such as '50 nm/V' (--sensitivity on the command line)",
                    "sensitivity",
                )
            factor *= calibration.sensitivity
        return factor * columns[name].values

    (name,) = names
    position = si(name)
    if "force" in columns:
        force = si("force")
    else:
        force = calibration.required_spring_constant() * si("deflection")
    if not of_tip:
        if "deflection" in columns:
            deflection = si("deflection")
        else:
            deflection = force / calibration.required_spring_constant(
                f", and column {name} is that of the cantilever's base, from which the deflection "
                "must be subtracted"
            )
        position = (position if name == "extension" else -position) - deflection
    time = None
    messages: tuple[str, ...] = ()
    if "time" in columns:
        unit, values, own_name = columns["time"]
        rows = np.isfinite(position) & np.isfinite(force)
        if unit and values.shape == rows.shape and grows(values[rows]):
            time = si("time")
        else:
            reason = "falls, stands still or has a row without a number" if unit else "has no unit"
            text = f"column {own_name or 'time'} {reason}, so the curve is taken as one without"
            messages = (Note(f"{text} time"),)
            columns = {role: channel for role, channel in columns.items() if role != "time"}
    return Measurement(
        position,
        force,
        name == "depth",
        messages,
        stiffness=calibration.spring_constant,
        time=time,
        speed=calibration.speed,
        origin=Origin(
            columns={role: f"{c.name or role} [{c.unit}]" for role, c in columns.items()},
            sensitivity=calibration.sensitivity,
        ),
    )


def si_unit(unit: str) -> str:
    """Return the SI unit of a length, force, voltage or time; empty for anything else."""
    for si in "mNVs":
        with suppress(ValueError):
            Quantity(si)(f"1 {unit}")
            return si
    return ""


def _factor(name: str, unit: str) -> float:
    """Return the factor from the unit of a column to SI, of a deflection in volts to V."""
    if not unit:
        raise ConfigError(
            f"column {name} has no unit; write it in the header, e.g. {EXAMPLE!r}, or in columns "
            "(--columns on the command line)"
        )
    found, (si, typical) = si_unit(unit), _UNITS.get(name, ("m", "nm"))
    if found == si or (name, found) == ("deflection", "V"):
        return Quantity(found)(f"1 {unit}")
    hint = (
        "; a signal in volts is a column deflection, which becomes a force by sensitivity "
        "[m/V] and spring constant [N/m]"
    )
    raise ConfigError(
        f"column {name} is in {shown(unit)}, which is not a unit of {name}; give it in "
        f"{si} or a multiple, e.g. {f'{name} [{typical}]'!r}{hint if found == 'V' else ''}"
    )
