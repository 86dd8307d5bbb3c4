"""Explanations of components and of tables of run files: meaning, fields and an example."""

from __future__ import annotations

import inspect
import itertools
import json
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pellicle.components import Prescription
from pellicle.components.installed import registry
from pellicle.errors import ConfigError, PluginError, excerpt
from pellicle.grid import Grid
from pellicle.plugins.registry import InstalledComponent
from pellicle.schema.messages import similar

from .describe import FieldRow, field_rows
from .loading import Loading, Options, keys_of, prescriptions
from .run import Run
from .study import Study

_TABLES: Mapping[str, type[BaseModel]] = {
    "run": Run,
    "grid": Grid,
    "loading": Loading,
    "study": Study,
}
_EXAMPLES: Mapping[str, str] = {
    "grid": '[grid]\npoints = 256\nsize = "0.4 mm"\nboundary = "free"',
    "loading": '[loading]\ndepth = { start = "1 um", stop = "5 um", num = 5 }',
    "study": '[study.vary]\n"kernel.tension" = ["0 mN/m", "10 mN/m", "50 mN/m"]',
}


class Explanation(NamedTuple):
    """A component or a table of a run file."""

    name: str
    kind: str
    """Its family, or "table"."""
    origin: str
    """Distribution and version of a component; empty for a table."""
    text: str
    """Its meaning."""
    fields: list[FieldRow]
    example: str
    """TOML."""


def explanations(word: str, tables: Mapping[str, type[BaseModel]]) -> list[Explanation]:
    """Return what is known of a type, of a family or of a table, one of ``tables`` or of a run.

    A type may stand with its family, as in ``kernel.half_space``.
    """
    entries = {**tables, **_TABLES}
    name = re.sub(r"[\s-]+", "_", word.strip().strip("[]").lower())
    families = registry().components
    if name in entries:
        return [_of_table(name, entries[name])]
    family = name if name in families else name.removesuffix("s")
    if family in families:
        types = [FieldRow(t, "", t, "", entry.summary) for t, entry in families[family].items()]
        meaning = _documentation(registry().families[family])
        return [Explanation(family, "family", "", meaning, types, "")]
    family_name, _, type_ = name.rpartition(".")
    matches = [
        members[type_]
        for family, members in families.items()
        if type_ in members and family_name in ("", family, f"{family}s")
    ]
    if not matches:
        for broken in registry().broken:
            entry = broken.origin.entry_point
            if name in (entry, *entry.split(".")):
                raise PluginError(f"{excerpt(word)} is broken: {broken}")
        hint = similar(name, {*entries, *families, *itertools.chain(*families.values())})
        raise ConfigError(
            f"{excerpt(word)} is neither a type, a family nor a table of what is installed; "
            f"{hint or 'see `pellicle plugins`'}",
            "TYPE",
        )
    return [_of_component(match) for match in matches]


def words_by_kind(tables: Mapping[str, type[BaseModel]]) -> dict[str, list[str]]:
    """Return what `explanations` knows: tables, these further ones too, and types by family."""
    return {"table": [*{**_TABLES, **tables}]} | {
        family: list(members) for family, members in registry().components.items()
    }


def _of_table(name: str, model: type[BaseModel]) -> Explanation:
    rows = [*field_rows((Options if model is Loading else model).model_fields)]
    if model is Study:
        rows = [row for row in rows if row.name != "run"]
    if model is Loading:
        of_types = []
        for type_, component in prescriptions().items():
            for row in field_rows(keys_of(component)):
                required = "one of these" if row.name == type_ else f"with {type_}"
                of_types.append(row._replace(default=row.default.replace("required", required)))
        rows = [row for row in of_types if row.name not in Options.model_fields] + rows
    examples = getattr(model, "examples", ())
    example = _EXAMPLES.get(name) or (_lines(examples[0]) if examples else "")
    return Explanation(name, "table", "", _documentation(model), rows, example)


def _of_component(entry: InstalledComponent) -> Explanation:
    component, example = entry.component, ""
    fields: Mapping[str, FieldInfo] = component.model_fields
    table: dict[str, Any] = {"type": entry.type}
    if issubclass(component, Prescription):
        fields, table = keys_of(component), {entry.type: [component.quantity().example]}
    if entry.examples and component.place:
        name = component.place.replace("[]", "")
        # A line for each key, and inner tables on one.
        head = f"[[{name}]]" if component.place.endswith("[]") else f"[{name}]"
        example = f"{head}\n{_lines({**table, **entry.examples[0]})}"
    origin = f"{entry.origin.distribution} {entry.origin.version}"
    rows, text = [*field_rows(fields)], _documentation(component)
    return Explanation(entry.type, component.family, origin, text, rows, example)


def _documentation(model: type[BaseModel]) -> str:
    return (inspect.getdoc(model) or "").replace("``", "").replace("`", "")


def _lines(table: Mapping[str, Any]) -> str:
    return "\n".join(f"{_key(key)} = {_inline(value)}" for key, value in table.items())


def _inline(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{_key(key)} = {_inline(v)}' for key, v in value.items())} }}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_inline, value))}]"
    # JSON writes texts, numbers and truth values as TOML does.
    return json.dumps(value, ensure_ascii=False, default=str)


def _key(name: str) -> str:
    return name if re.fullmatch(r"[\w-]+", name) else json.dumps(name)
