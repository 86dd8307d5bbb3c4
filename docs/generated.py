"""Write the parts of the documentation that the installed package itself knows best.

``python docs/generated.py`` brings the pages of docs/ up to date; a test compares them.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable
from pathlib import Path

import pellicle as pl
from pellicle.config.describe import FieldRow, field_rows
from pellicle.config.explain import explanations
from pellicle.units import readable
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
    "effect": "Effects of fits",
}


_PART = re.compile(r"(<!-- generated: (\w+) -->\n).*?(\n<!-- end -->)", re.DOTALL)


def fill_in(text: str) -> str:
    """Return a page with all that follows a ``<!-- generated: name -->`` brought up to date."""
    return _PART.sub(lambda part: f"{part[1]}\n{PARTS[part[2]]().strip()}\n{part[3]}", text)


def components() -> str:
    """Return a section for each registered component, with a table of its fields."""
    parts = []
    for family, members in pl.registry().components.items():
        parts += [f"## {_HEADINGS[family]}\n"] if members else []
        for type_, component in ((type_, entry.component) for type_, entry in members.items()):
            parts += [f"### `{type_}`\n", f"{inspect.getdoc(component)}\n"]
            if issubclass(component, pl.Prescription):
                values = ", ".join([component.unit, *component.quantity().bounds])
                pulls = "; with an `[interaction]` any" * component.may_pull
                parts.append(f"Key of `[loading]`. Load steps: {values}{pulls}.\n")
            rows = [*field_rows(component.model_fields)]
            parts.append(_fields(rows) if rows else "No fields.\n")
    return "\n".join(parts)


def tables() -> str:
    """Return the fields of a run or study file's tables that are no components."""
    parts = []
    models = {"run": pl.Run, "grid": pl.Grid, "loading": pl.Loading, "study": pl.Study}
    for name, model in models.items():
        (explanation,) = explanations(name, {})
        head = "top level" if name == "run" else f"[{name}]"
        parts.append(f"### `{head}`\n\n{inspect.getdoc(model)}\n\n{_fields(explanation.fields)}")
    return "\n".join(parts)


def options_of_fits() -> str:
    """Return the fields of the configuration of a fit."""
    return _fields(field_rows(pl.FitConfig.model_fields))


def _fields(rows: Iterable[FieldRow]) -> str:
    """Return a table of fields: unit and range, default, meaning."""
    cells = []
    for row in rows:
        in_words = re.fullmatch("none|fitted|required|see below|one of these|with .*", row.default)
        default = row.default if in_words else f"`{row.default}`"
        cells.append((f"`{row.name}`", row.kind, default, _cell(row.meaning)))
    return _table(("field", "takes", "default", "meaning"), cells)


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
