"""What a configuration takes in place of what it holds: a type, a diameter, the JSON of a fit."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo

from pellicle import registry
from pellicle.components import Component, HasForceCurve, Indenter
from pellicle.errors import ConfigError, all_problems, excerpt
from pellicle.units import Quantity


def component_table(value: object) -> object:
    """Return the type of a component as its table; any other value unchanged."""
    return {"type": value} if isinstance(value, str) else value


def as_list(value: object) -> Any:
    """Return a value that may stand for a list of one as that list."""
    return value if isinstance(value, (list, tuple)) else [value]


def list_or_entry(entries: Any) -> BeforeValidator:
    """Return the annotation of a list, in whose place one of its entries may stand."""
    return BeforeValidator(as_list, json_schema_input_type=entries)


def effect_list(entries: Any) -> BeforeValidator:
    """Return the annotation of a list of effects, of which "none" is the empty one."""
    return BeforeValidator(
        lambda value: [] if isinstance(value, str) and value == "none" else as_list(value),
        json_schema_input_type=entries,
    )


def with_radius(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return fields of an indenter with half of a diameter as the radius."""
    table = dict(fields)
    # A diameter beside a radius is no field.
    if "radius" not in table and not isinstance(table.get("diameter", []), (list, tuple)):
        with all_problems() as within, within("diameter"):
            table["radius"] = Quantity("m", above=0)(table.pop("diameter")) / 2
    return table


def indenter_or_table(value: object) -> Any:
    """Return an indenter, or its table if it lacks fields that each file may provide."""
    table = component_table(value)
    if isinstance(table, HasForceCurve):
        return table
    try:
        return registry().make(Indenter, table)
    except ConfigError as error:
        keys = dict(table) if isinstance(table, Mapping) else {"": None}
        if problems := [
            problem for problem in error.problems if problem.field.partition(".")[0] in keys
        ]:
            raise ConfigError(problems) from None
        return keys


def fields_of(indenter: object) -> Mapping[str, FieldInfo]:
    """Return the fields of the kind of an indenter or of its table."""
    kind = type(indenter)
    if isinstance(indenter, Mapping):
        kind = registry().find(Indenter.family, indenter.get("type", "sphere"))
    return getattr(kind, "model_fields", {})


def describe_indenter(indenter: object) -> dict[str, Any]:
    """Return an indenter, or the fields of one, as JSON data."""
    if isinstance(indenter, Component):
        return indenter.model_dump(mode="json", exclude_none=True)
    return dict(indenter) if isinstance(indenter, Mapping) else {"type": type(indenter).__name__}


def share_of(value: object) -> float:
    """Return a share; "5 %" is one of 0.05."""
    percent = isinstance(value, str) and value.endswith("%")
    number = Quantity("1", above=0)(str(value)[:-1] if percent else value)
    if (share := number / 100 if percent else number) > 1:
        text = f"{excerpt(value)} is a share of {100 * share:.6g} %, beyond 100 %"
        raise ConfigError(f'{text}; 10 % is 0.1 or "10 %"')
    return share


def config_of_record(path: Path) -> Any:
    """Return the configuration in the JSON of a fit, of a pool or of many fits of files."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        data, rows = content["configuration"], content["curves"]
        origins = [
            curve["data"] for row in rows for curve in row.get("curves", [row]) if "data" in curve
        ]
        if data["curves"] and all(origin["file"] for origin in origins):
            return data
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (ValueError, LookupError, TypeError, AttributeError):
        pass
    raise ConfigError(
        f"{path}: is not the JSON of a fit of files; give one that pellicle fit -o leaves, such as "
        "bead-fit.json or fits.json"
    )
