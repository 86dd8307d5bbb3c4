"""Translate pydantic's errors into messages that name field, value and remedy."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from pellicle.errors import ConfigError, Problem, excerpt


def nearest(word: object, candidates: Iterable[str]) -> str:
    """Return the known words as text, after ``did you mean 'x'?`` if one of them is similar."""
    names = sorted(candidates)
    hint = similar(word, names)
    return f"{hint}{' ' if hint else ''}Known: {', '.join(names) or 'none'}"


def no_field(name: object, candidates: Iterable[str]) -> str:
    """Return the message that a name is no field, with what comes nearest."""
    return f"is not a field here; {nearest(name, candidates)}"


def similar(word: object, candidates: Iterable[str]) -> str:
    """Return ``did you mean 'x'?`` if one of the known words is similar, or an empty text."""
    names, word = sorted(candidates), str(word)
    beginning = [name for name in names if len(word) > 2 and name.startswith(word)]
    close = difflib.get_close_matches(word, names, n=1) or beginning
    return f"did you mean {close[0]!r}?" if close else ""


def problems(
    model: type[BaseModel], details: Iterable[ErrorDetails], data: Mapping[str, Any]
) -> Iterable[Problem]:
    """Return the problems of ``data``, each once."""
    details = list(details)
    # pydantic also reports a list with an invalid entry as too short.
    outer = {detail["loc"][:-1] for detail in details}
    every = (
        problem
        for detail in details
        if not (detail["type"] == "too_short" and detail["loc"] in outer)
        for problem in _translated(model, detail, _path(detail["loc"], data))
    )
    return dict.fromkeys(every)


def _path(location: Iterable[int | str], data: object) -> str:
    """Return a dotted path as far as it exists in ``data``; one value may stand for a pair."""
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


def _translated(model: type[BaseModel], detail: ErrorDetails, field: str) -> Iterator[Problem]:
    cause = detail.get("ctx", {}).get("error")
    if isinstance(cause, ConfigError):
        yield from (cause.within(field) if field else cause).problems
        return
    match detail["type"]:
        case "missing":
            message = f"is missing; give it: {_description(model, field)}".rstrip(": ")
        case "extra_forbidden":
            candidates = [name for name in model.model_fields if name != "type"]
            message = no_field(field, candidates)
        case "value_error":
            message = str(cause)
        case "literal_error":
            literals = re.findall(r"'[^']*'|\d+", detail["ctx"]["expected"])
            allowed = [literal.strip("'") for literal in literals]
            message = (
                f"{excerpt(detail['input'])} is not allowed; {nearest(detail['input'], allowed)}"
            )
        case _:
            expected = _WANTED.get(detail["type"], "").format(**detail.get("ctx", {}))
            remedy = f"give {expected}" if expected else detail["msg"].replace("Input", "it")
            message = f"{excerpt(detail['input'])} is not allowed; {remedy}"
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
    "string_too_long": "a text of {max_length} letters or fewer",
}
"""Allowed values, by the type of pydantic's error."""


def _description(model: type[BaseModel], field: str) -> str:
    info = model.model_fields.get(field.split(".")[0])
    return (info.description if info else None) or ""
