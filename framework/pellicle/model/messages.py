"""What is wrong with a configuration, in the words of pellicle instead of pydantic's."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pydantic import (
    BaseModel,
)
from pydantic_core import ErrorDetails

from pellicle.errors import ConfigError, Problem, shown


def nearest(word: object, known: Iterable[str]) -> str:
    """Return ``"did you mean 'x'? "`` for a near miss, and what is known in any case."""
    names = sorted(known)
    close = difflib.get_close_matches(str(word), names, n=1)
    hint = f"did you mean {close[0]!r}? " if close else ""
    return f"{hint}Known: {', '.join(names) or 'none'}"


def problems(
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
