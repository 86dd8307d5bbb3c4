"""The frozen pydantic model that every part of a configuration is, with errors in our words."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import (
    BaseModel,
    ConfigDict,
    PlainSerializer,
    SerializationInfo,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)
from pydantic_core import ErrorDetails

from .errors import ConfigError, Problem, shown

_folder: ContextVar[Path | None] = ContextVar("folder", default=None)


@contextmanager
def paths_relative_to(folder: Path | None) -> Iterator[None]:
    """Read relative paths in a configuration as seen from ``folder``, where its file lies.

    With None, as seen from the current folder if no file is being read, and made absolute.
    """
    token = _folder.set(folder or _folder.get() or Path.cwd())
    try:
        yield
    finally:
        _folder.reset(token)


AS_GIVEN: Final = "as_given"
"""Context of ``model_dump`` in which paths are written as their file has them, not absolute."""


# Before Python 3.12 only the class of this system's paths can be derived from.
class _GivenPath(type(Path())):  # type: ignore[misc]
    """A path that knows how the user wrote it."""

    given = ""

    def __reduce__(self) -> tuple[Any, ...]:
        return _given_path, (str(self), self.given)


def _given_path(path: str | Path, given: str) -> Path:
    remembering = _GivenPath(path)
    remembering.given = given
    return remembering


def as_given(path: Path) -> str:
    """Return a path as the user wrote it, who may have moved its folder since."""
    return getattr(path, "given", "") or str(path)


def _from_folder(value: Any, read: ValidatorFunctionWrapHandler) -> Path:
    if isinstance(value, _GivenPath):
        return value
    path, folder = read(value), _folder.get()
    return _given_path(path if folder is None else (folder / path).absolute(), str(path))


def _written(path: Path, info: SerializationInfo) -> Path | str:
    if info.context == AS_GIVEN:
        return as_given(path)
    return str(path) if info.mode_is_json() else path


InputPath = Annotated[Path, WrapValidator(_from_folder), PlainSerializer(_written)]
"""A file to read; in a TOML file, relative to that file."""


class Model(BaseModel):
    """Frozen, no unknown fields; raises `ConfigError` that names field, value and remedy."""

    model_config = ConfigDict(extra="forbid", frozen=True, validate_default=False)

    # Positional only: "self" in a file is an unknown field like any other.
    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ConfigError(_problems(type(self), error.errors(), data)) from None


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


def nearest(word: object, known: Iterable[str]) -> str:
    """Return ``"did you mean 'x'? "`` for a near miss, and what is known in any case."""
    names = sorted(known)
    close = difflib.get_close_matches(str(word), names, n=1)
    hint = f"did you mean {close[0]!r}? " if close else ""
    return f"{hint}Known: {', '.join(names) or 'none'}"


def _problems(
    model: type[BaseModel], details: Iterable[ErrorDetails], data: Mapping[str, Any]
) -> Iterable[Problem]:
    """Return what is wrong with ``data``, each problem once."""
    details = list(details)
    # A list with a bad entry is also called too short: the entry's own problem says it better.
    outer = {detail["loc"][:-1] for detail in details}
    found = (
        problem
        for detail in details
        if not (detail["type"] == "too_short" and detail["loc"] in outer)
        for problem in _explain(model, detail, _path(detail["loc"], data))
    )
    return dict.fromkeys(found)


def _path(location: Iterable[int | str], data: object) -> str:
    """Return a dotted path as far as the user wrote it: one value may stand for a pair."""
    names = []
    for name in location:
        if isinstance(data, Mapping):
            data = data.get(name)
        elif isinstance(data, (list, tuple)):
            data = data[name] if isinstance(name, int) and name < len(data) else None
        else:
            break
        names.append(str(name))
    return ".".join(names)


def _explain(model: type[BaseModel], detail: ErrorDetails, field: str) -> Iterator[Problem]:
    """Yield the problems behind one pydantic error, in our words."""
    cause = detail.get("ctx", {}).get("error")
    if isinstance(cause, ConfigError):
        yield from (cause.within(field) if field else cause).problems
        return
    match detail["type"]:
        case "missing":
            message = f"is missing; give it: {_description(model, field)}".rstrip(": ")
        case "extra_forbidden":
            known = [name for name in model.model_fields if name != "type"]
            message = f"is not a field here; {nearest(field, known)}"
        case "value_error":
            message = str(cause)
        case "literal_error":
            found = re.findall(r"'[^']*'|\d+", detail["ctx"]["expected"])
            allowed = [each.strip("'") for each in found]
            message = (
                f"{shown(detail['input'])} is not allowed; {nearest(detail['input'], allowed)}"
            )
        case kind:
            wanted = _WANTED.get(kind, "").format(**detail.get("ctx", {}))
            remedy = f"give {wanted}" if wanted else detail["msg"].replace("Input", "it")
            message = f"{shown(detail['input'])} is not allowed; {remedy}"
            if description := _description(model, field):
                message += f" ({description})"
    yield Problem(field, message)


_WANTED = {
    "string_type": "text in quotes",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "int_parsing_size": "a smaller whole number",
    "finite_number": "a finite number",
    "float_type": "a number",
    "float_parsing": "a number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "tuple_type": "a list",
    "list_type": "a list",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "path_type": "the name of a file in quotes",
    "greater_than": "a value > {gt}",
    "greater_than_equal": "a value ≥ {ge}",
    "less_than": "a value < {lt}",
    "less_than_equal": "a value ≤ {le}",
    "too_short": "a list of {min_length} or more",
    "too_long": "a list of {max_length} or fewer",
}
"""What is allowed, by pydantic's kind of error."""


def _description(model: type[BaseModel], field: str) -> str:
    info = model.model_fields.get(field.split(".")[0])
    return (info.description if info else None) or ""
