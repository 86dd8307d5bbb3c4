"""Position and force of a curve, whatever the instrument calls them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from pellicle.arrays import Array
from pellicle.errors import ConfigError, shown
from pellicle.units import Quantity

EXAMPLE = "position [um],force [nN]"
_PLACES = {
    "position": "position of the indenter, growing into the solid",
    "depth": "position seen from first touch",
    "height": "height of the cantilever's base, falling on approach",
    "extension": "extension of the piezo, growing on approach",
}
_SIGNALS = {"force", "deflection"}
NAMES = (*_PLACES, "force", "deflection")
"""Columns that are known."""
_OF_BASE = ("height", "extension")
_VOLTS = ("V", "mV", "volt", "volts")
_SPRING = Quantity("N/m", above=0)
_SENSITIVITY = Quantity("m/V", above=0)
_NO_SPRING = (
    "is missing; give that of the cantilever with its unit, such as '0.05 N/m' "
    "(--spring-constant on the command line)"
)


class Column(NamedTuple):
    """Values, and the text of their unit."""

    unit: str
    values: Array


@dataclass(frozen=True)
class Measured:
    """One curve in SI: force [N], and position or depth [m], each of shape (n,)."""

    force: Array
    position: Array | None = None
    depth: Array | None = None
    messages: tuple[str, ...] = ()
    """What the reader thinks strange."""
    stiffness: float | None = None
    """Of the cantilever [N/m] whose deflection the position is without, if known."""


@dataclass(frozen=True)
class Calibration:
    """What turns the signal of a cantilever into force and deflection; None if not given."""

    spring_constant: float | None = None
    """[N/m]."""
    sensitivity: float | None = None
    """Deflection over the signal of the detector [m/V]."""

    @classmethod
    def of(cls, spring_constant: Any = None, sensitivity: Any = None) -> Calibration:
        """Return the calibration that is given as texts with units or in SI.

        Raises
        ------
        ConfigError
            One of them is not such a value.
        """
        made = {}
        for name, quantity, value in (
            ("spring_constant", _SPRING, spring_constant),
            ("sensitivity", _SENSITIVITY, sensitivity),
        ):
            try:
                made[name] = None if value is None else quantity(value)
            except ValueError as error:
                raise ConfigError(str(error), name) from None
        return cls(**made)

    def stiffness(self) -> float:
        """Return the spring constant [N/m].

        Raises
        ------
        ConfigError
            It is not known.
        """
        if self.spring_constant is None:
            raise ConfigError(_NO_SPRING, "spring_constant")
        return self.spring_constant


def is_curve(columns: Mapping[str, Column]) -> bool:
    """Return whether there is a signal and a place."""
    return bool(_SIGNALS & columns.keys()) and bool(_PLACES.keys() & columns.keys())


def from_columns(columns: Mapping[str, Column], calibration: Calibration) -> Measured:
    """Return the curve that columns of these names hold.

    Force is ``force``, or the spring constant times ``deflection``, which may be in volts if the
    sensitivity is known.  Position is ``position`` or ``depth``; else it is that of the
    cantilever's base, ``extension`` or minus ``height``, less the deflection.

    Raises
    ------
    ConfigError
        A column, a unit or a calibration is missing, or measures something else.
    """
    if not _SIGNALS & columns.keys():
        raise ConfigError(
            f"has no column force (columns: {', '.join(columns) or 'none that is known'}); give a "
            f"header such as {EXAMPLE!r}"
        )
    given = [name for name in ("position", "depth") if name in columns]
    places = given or [name for name in _OF_BASE if name in columns]
    if len(places) != 1:
        what = f"both {' and '.join(places)}" if places else "no column position or depth"
        raise ConfigError(f"has {what}; give one of them, e.g. {EXAMPLE!r}")
    (name,) = places
    place = _factor(name, columns[name].unit) * columns[name].values
    force = (
        _factor("force", columns["force"].unit) * columns["force"].values
        if "force" in columns
        else calibration.stiffness() * _deflection(columns["deflection"], calibration)
    )
    stiffness = calibration.spring_constant
    if name == "depth":
        return Measured(force, depth=place, stiffness=stiffness)
    if name == "position":
        return Measured(force, place, stiffness=stiffness)
    deflection = (
        _deflection(columns["deflection"], calibration)
        if "deflection" in columns
        else force / _base_stiffness(name, calibration)
    )
    base = place if name == "extension" else -place
    return Measured(force, base - deflection, stiffness=stiffness)


def _base_stiffness(name: str, calibration: Calibration) -> float:
    try:
        return calibration.stiffness()
    except ConfigError as error:
        raise ConfigError(
            f"column {name} is the {_PLACES[name]}, from which the deflection must be subtracted: "
            f"{error}"
        ) from None


def _deflection(column: Column, calibration: Calibration) -> Array:
    if column.unit not in _VOLTS:
        return _factor("deflection", column.unit) * column.values
    if calibration.sensitivity is None:
        raise ConfigError(
            f"is missing, and column deflection is in {shown(column.unit)}; give it with its unit, "
            "such as '50 nm/V' (--sensitivity on the command line)",
            "sensitivity",
        )
    return calibration.sensitivity * Quantity("V")(f"1 {column.unit}") * column.values


def _factor(name: str, unit: str) -> float:
    """Return what a column is to be multiplied by."""
    wanted = "N" if name == "force" else "m"
    if not unit:
        raise ConfigError(f"column {name} has no unit; write it in the header, e.g. {EXAMPLE!r}")
    try:
        return Quantity(wanted)(f"1 {unit}")
    except ValueError:
        hint = (
            "; a signal in volts is a column deflection, which becomes a force by sensitivity "
            "[m/V] and spring constant [N/m]"
            if unit in _VOLTS
            else ""
        )
        raise ConfigError(
            f"column {name} is in {shown(unit)}, which is no unit of {name}; give it in "
            f"{wanted} or a multiple, e.g. {EXAMPLE!r}{hint}"
        ) from None
