"""Values of nested models by their dotted path."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pellicle.errors import ConfigError, shown

from .base import Model


def replaced(data: Any, key: str, value: object) -> Any:
    """Return a copy of a configuration with ``value`` where the dotted ``key`` leads.

    Tables that are not there are made; entries of lists count from 0; a key of a table may itself
    have dots.

    Raises
    ------
    ConfigError
        It leads into what is no table.
    """
    return _replaced(data, key.split("."), value, "")


def _replaced(at: Any, names: list[str], value: object, where: str) -> Any:
    if not names:
        return value
    if isinstance(at, Model):
        at = {name: getattr(at, name) for name in type(at).model_fields if _is_said(at, name)}
    if isinstance(at, Mapping):
        count = next((n for n in range(len(names), 1, -1) if ".".join(names[:n]) in at), 1)
        name = ".".join(names[:count])
        inner = _replaced(at.get(name, {}), names[count:], value, f"{where}{name}.")
        return {**at, name: inner}
    place = where.removesuffix(".")
    if not isinstance(at, (list, tuple)):
        raise ConfigError(f"{place} = {shown(at)} is not a table; replace it as a whole: {place}")
    if not names[0].isdecimal() or int(names[0]) >= len(at):
        raise ConfigError(
            f"{place} has no entry {names[0]}; give one of its {len(at)}, counted from 0"
        )
    index = int(names[0])
    inner = _replaced(at[index], names[1:], value, f"{where}{index}.")
    return [*at[:index], inner, *at[index + 1 :]]


def _is_said(model: Model, name: str) -> bool:
    return name == "type" or name in model.model_fields_set
