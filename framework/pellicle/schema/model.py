"""The base class of all configuration, and the values in it by their dotted path.

Entries of lists count from 0, as in ``grid.size.0``; a key of a table may itself contain dots.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo

from pellicle.errors import ConfigError, excerpt

from .messages import problems

_DEEPEST = 100
"""Most tables through which a path leads."""


class Model(BaseModel):
    """A frozen model that refuses unknown fields with a `ConfigError` naming field and remedy."""

    model_config = ConfigDict(extra="forbid", frozen=True, validate_default=False)
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ()
    """Its fields as a user would write them: the first is the example of ``pellicle explain``, all
    those of components are asked by ``pellicle plugins --check``."""

    # Positional only, so that a key "self" in a file is refused as an unknown field.
    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ConfigError(problems(type(self), error.errors(), data)) from None

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy with the fields of ``update``, which are not validated."""
        copy = super().model_copy(update=update, deep=deep)
        # Cached properties are those of the fields before the update.
        for name in copy.__dict__.keys() - type(self).model_fields.keys():
            del copy.__dict__[name]
        return copy

    @property
    def entries(self) -> Mapping[str, tuple[Any, FieldInfo]]:
        """Value and description of each key of its table in a file."""
        return {name: (getattr(self, name), info) for name, info in type(self).model_fields.items()}


def get(at: Any, path: str) -> Any:
    """Return the value at a path, or None if the path does not exist."""
    names = path.split(".")
    while names and at is not None:
        name, names = _head(at, names)
        if isinstance(at, Mapping):
            at = at.get(name)
        elif isinstance(at, (list, tuple)):
            at = at[int(name)] if name.isdecimal() and int(name) < len(at) else None
        else:
            at = at.entries.get(name, (None, None))[0] if isinstance(at, Model) else None
    return at


def with_value(at: Any, path: str, value: object) -> Any:
    """Return a model, or a list, made anew with another value at a path; it is validated."""
    name, _, rest = path.partition(".")
    if isinstance(at, Model):
        fields = {field: getattr(at, field) for field in at.model_fields_set}
        return type(at)(**fields | {name: with_value(fields[name], rest, value) if rest else value})
    index = int(name)
    return (*at[:index], with_value(at[index], rest, value) if rest else value, *at[index + 1 :])


def walk(at: Any, path: str = "") -> list[tuple[str, Any, FieldInfo | None]]:
    """Return path, value and field of each value below ``at``, outer ones before inner ones.

    Entries of a list have the field of the list; those of a table have none.
    """
    values: list[tuple[str, Any, FieldInfo | None]] = []
    waiting: list[tuple[str, Any, FieldInfo | None]] = [(path, at, None)]
    while waiting:
        place, value, field = waiting.pop()
        prefix = f"{place}." if values else path
        values.append((place, value, field))
        if isinstance(value, Model):
            for name, (entry, info) in reversed([*value.entries.items()]):
                waiting.append((f"{prefix}{name}", entry, info))
        elif isinstance(value, Mapping):
            waiting += [(f"{prefix}{name}", value[name], None) for name in reversed([*value])]
        elif isinstance(value, (list, tuple)):
            indices = reversed(range(len(value)))
            waiting += [(f"{prefix}{index}", value[index], field) for index in indices]
    return values[1:]


def python_names(paths: Iterable[str]) -> dict[str, str]:
    """Return a name for each path that Python can write: ``kernel_tension``.

    Where two paths would have one name, a dot becomes two underscores.
    """
    paths = list(paths)
    plain = [path.replace(".", "_") for path in paths]
    return {
        path: name if plain.count(name) == 1 else path.replace(".", "__")
        for path, name in zip(paths, plain, strict=True)
    }


def replace_at(data: Any, path: str, value: object) -> Any:
    """Return a copy of a configuration with ``value`` at a path; missing tables are created.

    The copy of a model is a table of the fields that were set.

    Raises
    ------
    ConfigError
        The path leads into a value that is not a table, beyond the end of a list, or too deep.
    """
    if (depth := path.count(".")) > _DEEPEST:
        raise ConfigError(f"{excerpt(path)} leads through {depth} tables; give {_DEEPEST} at most")
    return _replaced(data, path.split("."), value, "")


def _replaced(at: Any, names: list[str], value: object, path: str) -> Any:
    if not names:
        return value
    if isinstance(at, Model):
        left_out = type(at).model_fields.keys() - at.model_fields_set - {"type"}
        at = {name: value for name, (value, _) in at.entries.items() if name not in left_out}
    name, rest = _head(at, names)
    if isinstance(at, Mapping):
        return {**at, name: _replaced(at.get(name, {}), rest, value, f"{path}{name}.")}
    whole = path.removesuffix(".")
    if not isinstance(at, (list, tuple)):
        raise ConfigError(f"{whole} = {excerpt(at)} is not a table; replace it as a whole: {whole}")
    if not name.isdecimal() or int(name) >= len(at):
        raise ConfigError(f"{whole} has no entry {name}; give one of its {len(at)}, counted from 0")
    index = int(name)
    inner = _replaced(at[index], rest, value, f"{path}{index}.")
    return [*at[:index], inner, *at[index + 1 :]]


def _head(at: Any, names: list[str]) -> tuple[str, list[str]]:
    """Return the first name of a path in ``at``, the longest that is a key of it, and the rest."""
    lengths = range(len(names), 1, -1) if isinstance(at, Mapping) else ()
    count = next((n for n in lengths if ".".join(names[:n]) in at), 1)
    return ".".join(names[:count]), names[count:]
