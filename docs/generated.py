"""Write the parts of the documentation that the installed package itself knows best.

``python docs/generated.py`` brings the pages of docs/ up to date; a test compares them.
"""

from __future__ import annotations

import re
import types
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

import pellicle as pl
from pellicle.schema import Model
from pellicle.units import Quantity, quantity_of, readable
from pellicle.variables import VARIABLES, Variable

_HEADINGS = {
    "kernel": "Kernels",
    "indenter": "Indenters",
    "interaction": "Interactions",
    "solver": "Solvers",
    "correction": "Corrections of the area",
    "output": "Outputs",
    "executor": "Executors",
    "prescription": "Prescriptions",
}


_PART = re.compile(r"(<!-- generated: (\w+) -->\n).*?(\n<!-- end -->)", re.DOTALL)


def fill_in(text: str) -> str:
    """Return a page with all that follows a ``<!-- generated: name -->`` brought up to date."""
    return _PART.sub(lambda part: f"{part[1]}\n{PARTS[part[2]]().strip()}\n{part[3]}", text)


def components() -> str:
    """Return a section for each registered component, with a table of its fields."""
    return "\n".join(_components())


def _components() -> Iterator[str]:
    for family, members in pl.registry().components.items():
        if not members:
            continue
        yield f"## {_HEADINGS[family]}\n"
        for registered in members.values():
            yield f"### `{registered.type}`\n"
            yield f"{_paragraphs(registered.component.__doc__)}\n"
            if issubclass(registered.component, pl.Prescription):
                prescription = registered.component
                values = ", ".join([prescription.unit, *prescription.quantity().bounds])
                pulls = "; with an `[interaction]` any" * prescription.may_pull
                yield f"Key of `[loading]`. Load steps: {values}{pulls}.\n"
            yield fields(registered.component)


def tables() -> str:
    """Return the fields of a run or study file's tables that are no components."""
    parts = [
        f"### `{name}`\n\n{_paragraphs(model.__doc__)}\n\n{fields(model)}"
        for name, model in (
            ("top level", pl.Run),
            ("[grid]", pl.Grid),
            ("[loading]", pl.Loading),
            ("[study]", pl.Study),
        )
    ]
    return "\n".join(parts)


def options_of_fits() -> str:
    """Return the fields of the configuration of a fit."""
    return fields(pl.FitConfig)


_READ_OTHERWISE = (pl.Study, "run"), (pl.Loading, "prescription"), (pl.Loading, "path")
"""Fields that no key of a table has."""


def fields(model: Any) -> str:
    """Return a table of the fields of a model: unit and range, default, meaning."""
    rows = [
        (
            f"`{name}`",
            _accepts(info),
            "required" if info.is_required() else default(info, "`"),
            _cell(info.description or ""),
        )
        for name, info in model.model_fields.items()
        if name != "type" and (model, name) not in _READ_OTHERWISE
    ]
    return _table(("field", "takes", "default", "meaning"), rows) if rows else "No fields.\n"


_DIMENSIONS = {"field": "step, x, y", "path": "none", "oscillation": "none"}


def variables() -> str:
    """Return a table of the variables of a result."""
    rows = [
        (f"`{v.name}`", _DIMENSIONS.get(v.kind, "step"), v.unit, v.meaning)
        for v in (*VARIABLES.values(), *_prescribed())
    ]
    return _table(("variable", "dimensions", "unit", "meaning"), rows)


def _prescribed() -> Iterable[Variable]:
    """Return the variables that prescriptions add to a result, each once."""
    entry = pl.registry().components["prescription"].values()
    return dict.fromkeys(v for r in entry for v in r.component.variables)  # type: ignore[attr-defined]


def cases() -> str:
    """Return a table of the cases that ``pellicle validate`` solves."""
    rows = [
        (case.name, _value(case.expected, case.unit), f"{case.tolerance:.0e}", _cell(case.source))
        for suite in pl.registry().suites
        for case in suite()
    ]
    return _table(("case", "expected", "allowed", "source"), rows)


def _value(value: float, unit: str) -> str:
    return readable(value, unit.translate({ord("²"): "2", ord("³"): "3"}))


def statuses() -> str:
    """Return a table of how a step may end and what is said about it."""
    return _table(
        ("status", "message"),
        [(f"`{status.name}`", _message(status.value)) for status in pl.Status],
    )


def stops() -> str:
    """Return a table of why a solver may stop and the remedy that it stands for."""
    return _table(
        ("reason", "remedy"), [(f"`{status.name}`", _message(status.value)) for status in pl.Stop]
    )


def starter() -> str:
    """Return the starter file that ``pellicle new`` writes, as a block."""
    text = (Path(pl.__file__).parent / "examples" / "indent" / "indent.toml").read_text(
        encoding="utf-8"
    )
    return f"```toml\n{text}```"


PARTS = {
    part.__name__: part
    for part in (
        components,
        tables,
        options_of_fits,
        variables,
        cases,
        statuses,
        stops,
        starter,
    )
}


def default(info: FieldInfo, quote: str = "") -> str:
    """Return the default of a field as a TOML file would say it."""
    value = info.get_default(call_default_factory=True)
    if hasattr(value, "type"):
        return f"{quote}{value.type}{quote}"
    if isinstance(value, bool):
        return f"{quote}{str(value).lower() if quote else value}{quote}"
    if value is None or value in ((), ""):
        return "none" if quote else repr(value)
    if quote and isinstance(value, str):
        return f'{quote}"{value}"{quote}'
    return f"{quote}{list(value) if quote and isinstance(value, tuple) else value!r}{quote}"


def _accepts(info: FieldInfo) -> str:
    """Return what a field takes: unit and bounds of a quantity, or its kind of value."""
    if quantity := quantity_of(info):
        return _range(quantity)
    kind = _kind(info.annotation)
    bounds = [f"{sign} {bound}" for sign, bound in _bounds(info)]
    return ", ".join([kind, *bounds])


def _bounds(info: FieldInfo) -> Iterator[tuple[str, Any]]:
    for entry in info.metadata:
        for sign, name in ((">", "gt"), ("≥", "ge"), ("<", "lt"), ("≤", "le")):
            if (bound := getattr(entry, name, None)) is not None:
                yield sign, bound


def _range(quantity: Quantity) -> str:
    unit = "number" if quantity.unit == "1" else quantity.unit
    return ", ".join([unit, *quantity.bounds])


def _kind(annotation: Any) -> str:
    """Return a word for a type that is no quantity."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _kind(inner[0])
    if origin is Literal:
        return " or ".join(f'"{value}"' for value in inner)
    if origin in (Union, types.UnionType):
        return " or ".join(dict.fromkeys(_kind(kind) for kind in inner if kind is not type(None)))
    if origin is tuple:
        kinds = {_kind(kind) for kind in inner if kind is not Ellipsis}
        return f"list of {' and '.join(sorted(kinds))}"
    if origin is dict or (isinstance(annotation, type) and issubclass(annotation, Model)):
        return "table"
    names = {
        bool: "true or false",
        int: "whole number",
        float: "number",
        str: "text",
        Path: "file",
        Any: "array",
        pl.HasForceCurve: "force curve",
    }
    return names[annotation]


def _paragraphs(documentation: str | None) -> str:
    lines = (documentation or "").strip().splitlines()
    return "\n".join(line.strip() for line in lines)


def _message(text: str) -> str:
    return _cell(re.sub(r"\{[^}]*\}", "…", text))


def _cell(text: str) -> str:
    """Return a text as it is, whatever of it Markdown would take for markup."""
    return re.sub(r"([|*<_])", r"\\\1", text)


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


if __name__ == "__main__":
    for page in sorted(Path(__file__).parent.glob("*.md")):
        page.write_text(fill_in(page.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
