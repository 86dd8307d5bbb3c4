"""Values of parameters: lists, and ranges ``{start, stop, num}``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sized
from numbers import Integral
from typing import Any, cast

from pellicle.errors import ConfigError, all_problems, excerpt
from pellicle.units import Quantity, split

Values = tuple[Any, ...]
Axes = Mapping[str, Values]
"""Values of several axes by their dotted key."""
RANGE = {"start", "stop", "num"}
SPACINGS = ("linear", "log")
_MOST = 1_000_000


def expand(table: object) -> dict[str, Values]:
    """Return the values of each axis of a study's table, ranges written out."""
    if not isinstance(table, Mapping):
        raise ConfigError(f'{excerpt(table)} is not a table; give one: "kernel.tension" = […]')
    axes: dict[str, Values] = {}
    with all_problems() as within:
        for key, values in _flat(table, ""):
            with within(key):
                if key in axes:
                    raise ConfigError("is given twice; leave one out")
                axes[key] = _values(values)
    return axes


def _flat(table: Mapping[str, Any], path: str) -> Iterator[tuple[str, object]]:
    """Yield each axis with its dotted key; TOML turns an unquoted one into nested tables."""
    for name, value in table.items():
        if isinstance(value, Mapping) and value and not RANGE & value.keys():
            yield from _flat(value, f"{path}{name}.")
        else:
            yield f"{path}{name}", value


def _values(spec: object) -> Values:
    if isinstance(spec, Mapping):
        return expand_range(spec)
    if hasattr(spec, "tolist"):
        spec = spec.tolist()
    if not isinstance(spec, (list, tuple)):
        raise ConfigError(
            f"{excerpt(spec)} is not allowed; give a list of values, or {{start, stop, num}}"
        )
    if not spec:
        raise ConfigError("is empty; give at least one value, or leave the axis out")
    return tuple(value.item() if hasattr(value, "item") else value for value in spec)


def expand_range(
    table: Mapping[str, Any], what: str = "range", options: str = 'spacing = "log"'
) -> Values:
    """Return the values of ``{start, stop, num}``, which may also have a ``spacing``.

    If the ends have a unit, the values are texts with that unit. ``what`` and ``options`` are the
    name of the range and its optional keys in messages.
    """
    if not table.keys() >= RANGE or not table.keys() <= RANGE | {"spacing"}:
        has = ", ".join(map(str, table)) or "nothing"
        raise ConfigError(
            f"a {what} that has {has} is not allowed; give start, stop and num, and {options} if "
            "need be"
        )
    num, spacing = table["num"], table.get("spacing", "linear")
    if not isinstance(num, Integral) or isinstance(num, bool) or not 2 <= int(num) <= _MOST:
        raise ConfigError(
            f"{excerpt(num)} is not allowed; give a whole number of values, 2 to {_MOST}", "num"
        )
    if spacing not in SPACINGS:
        raise ConfigError(f'{excerpt(spacing)} is not allowed; give "linear" or "log"', "spacing")
    (start, unit), (stop, stop_unit) = (_end(table, end) for end in ("start", "stop"))
    if unit != stop_unit:
        if not unit or not stop_unit:
            raise ConfigError("give start and stop both with a unit, or both without")
        try:
            stop = Quantity(unit)(table["stop"])
        except ValueError as error:
            raise ConfigError(str(error), "stop") from None
    if start == stop:
        raise ConfigError("starts where it stops; give two ends, or a list of one value")
    if spacing == "log" and (start == 0 or stop / start <= 0):
        raise ConfigError('spacing = "log" needs start and stop ≠ 0 of the same sign')
    values = ramp(start, stop, int(num), log=spacing == "log")
    if unit:
        return tuple(f"{value:.15g} {unit}" for value in values)
    whole = isinstance(table["start"], int) and isinstance(table["stop"], int)
    return tuple(map(int, values) if whole and all(v.is_integer() for v in values) else values)


def is_path(spec: object) -> bool:
    """Return whether a value stands for several: a list, a tuple, an array or a table."""
    # Arrays of one number and text have a length too.
    return isinstance(spec, Sized) and not isinstance(spec, str) and getattr(spec, "ndim", 1) > 0


def path_of(spec: object, quantity: Quantity) -> tuple[float, ...]:
    """Return the values, in SI, of one value, a list, or a ramp, which may return to its start."""
    if isinstance(spec, Mapping):
        return _there_and_back(spec, quantity)
    if not is_path(spec):
        return _all({"": spec}, quantity)
    values = list(cast("Iterable[object]", spec))
    if not values:
        raise ValueError("is empty; give at least one load step")
    return _all({str(index): value for index, value in enumerate(values)}, quantity)


def _there_and_back(table: Mapping[Any, Any], quantity: Quantity) -> tuple[float, ...]:
    back = table.get("back", False)
    if not isinstance(back, bool):
        raise ConfigError(f"{excerpt(back)} is not allowed; give true or false", "back")
    once = {key: value for key, value in table.items() if key != "back"}
    ends = {end: once[end] for end in ("start", "stop") if end in once}
    once |= zip(ends, _all(ends, quantity), strict=True)
    values = expand_range(once, "ramp", 'back = true or spacing = "log"')
    return values + values[-2::-1] if back else values


def _all(values_by_place: Mapping[str, object], quantity: Quantity) -> tuple[float, ...]:
    """Return all values in SI, or raise an error that names all values not allowed."""
    values = []
    with all_problems() as within:
        for where, value in values_by_place.items():
            with within(where):
                values.append(quantity(value))
    return tuple(values)


def path_schemas(value: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the JSON schemas of one value, of a ramp and of a list, given that of a value."""
    ramp = {
        "type": "object",
        "properties": {
            "start": value,
            "stop": value,
            "num": {"type": "integer", "minimum": 2},
            "spacing": {"enum": list(SPACINGS)},
            "back": {"type": "boolean"},
        },
        "required": sorted(RANGE),
        "additionalProperties": False,
    }
    return [dict(value), ramp, {"type": "array", "items": value, "minItems": 1}]


def _end(table: Mapping[str, Any], end: str) -> tuple[float, str]:
    value = table[end]
    try:
        number, unit = (split(value) or ("", "")) if isinstance(value, str) else (value, "")
        return Quantity("1")(number), unit
    except ValueError:
        raise ConfigError(
            f"{excerpt(table[end])} is not allowed; give a finite number, with a unit or without",
            end,
        ) from None


def ramp(start: float, stop: float, num: int, *, log: bool = False) -> list[float]:
    """Return ``num`` values from ``start`` to ``stop``, spaced evenly or geometrically."""
    shares = [i / (num - 1) for i in range(num)]
    values = (
        [start * (stop / start) ** share for share in shares]
        if log
        else [(start * (num - 1 - i) + stop * i) / (num - 1) for i in range(num)]
    )
    # Rounding to fifteen digits gives 3e-05 instead of 3.0000000000000004e-05.
    return [float(f"{value:.15g}") for value in values]
