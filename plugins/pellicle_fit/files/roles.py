"""Roles of columns: their names and units, and the option ``columns`` that assigns them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, NamedTuple

from pydantic import BeforeValidator, Field

from pellicle.errors import ConfigError, shown
from pellicle.schema import nearest
from pellicle.units import Quantity

EXAMPLE = "position [um],force [nN]"
POSITIONS = {
    "position": "position of the indenter, growing into the solid",
    "depth": "position relative to first touch",
    "height": "height of the cantilever's base, falling on approach",
    "extension": "extension of the piezo, growing on approach",
}
"""Names of columns that hold a position, and what they are."""
SIGNALS = {"force", "deflection"}
"""Names of columns of which one gives the force."""
TIME = "time"
"""Name of the column that holds the time."""
NAMES = (*POSITIONS, *sorted(SIGNALS, reverse=True), TIME)
"""Names of the columns that are read."""
LABEL = "curve"
"""Name of the column that tells the curves of one table apart."""
_SI = {"force": "N", "time": "s"}
"""Units of columns that are not lengths."""
_TYPICAL = {"m": "nm", "N": "nN", "s": "ms"}
"""Units of the examples in messages."""
OF_BASE = ("height", "extension")
"""Positions from which the deflection must be subtracted."""
_MAP = "Z = extension nm, Defl = deflection nm"
_ENTRY = re.compile(r'(?:"[^"]*"|[^,"])+')
_ROLES = (*NAMES, LABEL)


class Role(NamedTuple):
    """What a column holds."""

    name: str
    """One of `NAMES`, or the label that tells curves apart."""
    unit: str
    """Its unit as text; empty if the file states it."""


def column_map(value: object) -> dict[str, str]:
    """Return the roles of columns, such as ``{"Z": "extension nm"}``, in the order of `NAMES`.

    Parameters
    ----------
    value
        Such a table, or a text such as ``"Z = extension nm, Defl = deflection nm"``.

    Raises
    ------
    ConfigError
        A role or a unit is unknown, a role is given twice, or the text has another form.
    """
    if isinstance(value, str):
        entries = [entry.rpartition("=") for entry in _ENTRY.findall(value) if entry.strip()]
        if not entries or not all(equals for _, equals, _ in entries):
            raise ConfigError(f"{shown(value)} is not of the form {_MAP!r}")
        pairs = [(name.strip().strip('"'), role) for name, _, role in entries]
        if len(dict(pairs)) < len(pairs):
            raise ConfigError(f"{shown(value)} names a column twice; give each column one role")
        value = dict(pairs)
    if not isinstance(value, Mapping):
        raise ConfigError(f"{shown(value)} is not a table or a text such as {_MAP!r}")
    by_role: dict[str, tuple[str, str]] = {}
    for column, text in value.items():
        if not isinstance(text, str) or not text.strip():
            raise ConfigError(f"{shown(text)} is not a role with its unit; {_MAP!r}", column)
        role = role_of(text)
        if role.name not in _ROLES:
            raise ConfigError(f"{shown(role.name)} is not a role; {nearest(role.name, _ROLES)}")
        if role.name in by_role:
            raise ConfigError(f"{by_role[role.name][0]!r} and {column!r} are both {role.name}")
        if role.unit and role.name != LABEL:
            factor(role.name, role.unit)
        by_role[role.name] = str(column), f"{role.name} {role.unit}".strip()
    return dict(by_role[role] for role in _ROLES if role in by_role)


def role_of(text: str) -> Role:
    """Return the role that a text such as ``"extension nm"`` states."""
    name, _, unit = text.strip().partition(" ")
    return Role(name.lower(), unit.strip())


ColumnMap = Annotated[
    dict[str, str] | None,
    BeforeValidator(
        lambda value: None if value is None else column_map(value),
        json_schema_input_type=dict[str, str] | str | None,
    ),
    Field(
        description="roles of columns by name, by number or by path in the file: "
        '{ "Z" = "extension nm", "Defl" = "deflection nm" }'
    ),
]
"""Roles of columns with their units, by name, number or path; None if the names say them."""


def is_voltage(unit: str) -> bool:
    """Return whether a unit is one of voltage."""
    try:
        Quantity("V")(f"1 {unit}")
    except ValueError:
        return False
    return True


def factor(name: str, unit: str) -> float:
    """Return the factor from the unit of a column to SI; a deflection may be in volts.

    Raises
    ------
    ConfigError
        The column has no unit, or one that measures something else.
    """
    si = _SI.get(name, "m")
    if not unit:
        raise ConfigError(
            f"column {name} has no unit; write it in the header, e.g. {EXAMPLE!r}, or in columns "
            "(--columns on the command line)"
        )
    if is_voltage(unit):
        if name == "deflection":
            return Quantity("V")(f"1 {unit}")
        hint = (
            "; a signal in volts is a column deflection, which becomes a force by sensitivity "
            "[m/V] and spring constant [N/m]"
        )
    else:
        hint = ""
    try:
        return Quantity(si)(f"1 {unit}")
    except ValueError:
        raise ConfigError(
            f"column {name} is in {shown(unit)}, which is not a unit of {name}; give it in "
            f"{si} or a multiple, e.g. {f'{name} [{_TYPICAL[si]}]'!r}{hint}"
        ) from None
