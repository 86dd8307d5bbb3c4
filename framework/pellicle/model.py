"""The frozen pydantic model that every part of a configuration is, with errors in our words."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from .errors import ConfigError, Problem

_folder: ContextVar[Path | None] = ContextVar("folder", default=None)


@contextmanager
def paths_relative_to(folder: Path) -> Iterator[None]:
    """Read relative paths in a configuration as seen from ``folder``, where its file lies."""
    token = _folder.set(folder)
    try:
        yield
    finally:
        _folder.reset(token)


def _from_folder(path: Path) -> Path:
    folder = _folder.get()
    return path if folder is None else (folder / path).absolute()


InputPath = Annotated[Path, AfterValidator(_from_folder)]
"""A file to read; in a TOML file, relative to that file."""


class Model(BaseModel):
    """Frozen, no unknown fields; raises `ConfigError` that names field, value and remedy."""

    model_config = ConfigDict(extra="forbid", frozen=True, validate_default=False)

    def __init__(self, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ConfigError(
                problem for detail in error.errors() for problem in _explain(type(self), detail)
            ) from None


def nearest(word: object, known: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for a near miss, and what is known in any case."""
    names = sorted(known)
    close = difflib.get_close_matches(str(word), names, n=1)
    hint = f"did you mean {close[0]!r}? " if close else ""
    return f"{hint}Known: {', '.join(names) or 'none'}"


def _explain(model: type[BaseModel], detail: ErrorDetails) -> Iterator[Problem]:
    """Yield the problems behind one pydantic error, in our words."""
    field = ".".join(map(str, detail["loc"]))
    cause = detail.get("ctx", {}).get("error")
    if isinstance(cause, ConfigError):
        yield from (cause.within(field) if field else cause).problems
        return
    match detail["type"]:
        case "missing":
            message = f"is missing; {_describe(model, field)}"
        case "extra_forbidden":
            known = [name for name in model.model_fields if name != "type"]
            message = f"is not a field here; {nearest(field, known)}"
        case "value_error":
            message = str(cause)
        case _:
            message = f"{_shorten(detail['input'])} is not usable: {detail['msg']}"
            if (described := _describe(model, field)) != "give it":
                message += f"; {described}"
    yield Problem(field, message)


def _describe(model: type[BaseModel], field: str) -> str:
    info = model.model_fields.get(field.split(".")[0])
    return f"give it: {info.description}" if info and info.description else "give it"


def _shorten(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}…"
