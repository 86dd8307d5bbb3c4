"""Write the parts of the documentation that the installed package itself knows best.

``python docs/generated.py`` brings the pages of docs/ up to date; a test compares them.
"""

from __future__ import annotations

import inspect
import re
import tomllib
from collections import Counter
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Any

import pellicle as pl
from pellicle import analysis, testing
from pellicle.components import words_of_type
from pellicle.components.rules import CHEAP, requirement_of
from pellicle.config.describe import FieldRow, field_rows
from pellicle.config.explain import explanations
from pellicle.plugins.commands import commands, typer_command
from pellicle.units import readable
from pellicle.variables import VARIABLES, Variable
from pellicle_fit.effect import quantities
from pellicle_fit.estimation.noise import Flaw

_HEADINGS = {
    "kernel": "Kernels",
    "indenter": "Indenters",
    "load": "Loads",
    "interaction": "Interactions",
    "solver": "Solvers",
    "correction": "Corrections of the area",
    "output": "Outputs",
    "executor": "Executors",
    "prescription": "Prescriptions",
    "effect": "Effects of fits",
}


_SEVERAL = 2
"""Components from which on equal fields stand once."""
ROOT = Path(__file__).parents[1]
_PART = re.compile(r"(<!-- generated: (\w+) -->\n).*?(\n<!-- end -->)", re.DOTALL)


def fill_in(text: str) -> str:
    """Return a page with all that follows a ``<!-- generated: name -->`` brought up to date."""
    return _PART.sub(lambda part: f"{part[1]}\n{PARTS[part[2]]().strip()}\n{part[3]}", text)


def components() -> str:
    """Return a section for each family and component; what several share stands once."""
    parts = []
    for family, members in pl.registry().components.items():
        if not pl.registry().families[family].place or not members:
            continue
        fields = {
            type_: [*field_rows(entry.component.model_fields)] for type_, entry in members.items()
        }
        shared = _shared(fields.values())
        parts += [f"## {_HEADINGS[family]}\n"]
        parts += [f"Fields of several components:\n\n{_list(shared)}"] if shared else []
        for type_, entry in members.items():
            component = entry.component
            parts += [f"### `{type_}`\n", f"{inspect.getdoc(component)}\n"]
            if issubclass(component, pl.Prescription):
                values = ", ".join([component.unit, *component.quantity().bounds])
                pulls = "; with an `[interaction]` any" * component.may_pull
                parts.append(f"Key of `[loading]`. Load steps: {values}{pulls}.\n")
            common = [row.name for row in fields[type_] if row in shared]
            own = [row for row in fields[type_] if row not in shared]
            # The rows of a table follow that of the table.
            names = ", ".join(f"`{name}`" for name in common if "." not in name)
            parts += [f"As [above](#{_anchor(family)}): {names}.\n"] if common else []
            parts += [_list(own)] if own else []
            parts += [] if fields[type_] else ["No fields.\n"]
    return "\n".join(parts)


def _shared(components: Iterable[list[FieldRow]]) -> list[FieldRow]:
    """Return the fields that several components have alike, the most frequent one of each name."""
    number = Counter(row for rows in components for row in rows)
    frequent = {row.name: row for row, count in reversed(number.most_common()) if count >= _SEVERAL}
    return [row for row in number if frequent.get(row.name) == row]


def _list(rows: Iterable[FieldRow]) -> str:
    """Return a list of fields: unit and range, default, meaning."""
    lines = []
    for row in rows:
        default = {"none": "optional"}.get(row.default, _default(row))
        lines.append(f"- `{row.name}` ({row.kind}; {default}): {_cell(row.meaning)}\n")
    return "".join(lines)


def _default(row: FieldRow) -> str:
    in_words = re.fullmatch("none|fitted|required|see below|one of these|with .*", row.default)
    return row.default if in_words else f"`{row.default}`"


def _anchor(family: str) -> str:
    return _HEADINGS[family].lower().replace(" ", "-")


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
    cells = [(f"`{row.name}`", row.kind, _default(row), _cell(row.meaning)) for row in rows]
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
        (case.name, _value(case.expected, case.unit), f"{case.tolerance:.2g}", _cell(case.source))
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


def options_of_commands() -> str:
    """Return a section for each command: what it does, and a table of its arguments and options."""
    parts = []
    for name in commands():
        command: Any = typer_command(name)
        parts.append(f"### `pellicle {name}`\n\n{inspect.cleandoc(command.help)}\n")
        cells = []
        for parameter in command.params:
            names = [*parameter.opts, *parameter.secondary_opts]
            if parameter.param_type_name == "argument":
                names = [parameter.metavar or parameter.name.upper()]
            elif parameter.metavar:
                names[-1] += f" {parameter.metavar}"
            spelled = ", ".join(f"`{name}`" for name in names)
            cells.append((spelled, _cell(" ".join((parameter.help or "").split()))))
        parts.append(_table(("option", "meaning"), [c for c in cells if c[0] != "`--help`"]))
        parts.append("")
    return "\n".join(parts)


def functions() -> str:
    """Return a table of the public functions with their signatures and what they return."""
    rows = []
    for module in (pl, analysis):
        names = pl.__all__ if module is pl else dir(module)
        for name in names:
            function = getattr(module, name)
            public = inspect.isfunction(function) and not name.startswith("_")
            if public and (module is pl or function.__module__.startswith(module.__name__)):
                taken = ", ".join(inspect.signature(function).parameters)
                does = (inspect.getdoc(function) or "").partition("\n")[0].replace("``", "`")
                rows.append((f"`{module.__name__}.{name}({taken})`", does))
    return _table(("function", "does"), rows)


def extras() -> str:
    """Return a table of the extras of the package."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    names = re.compile(r"[\w-]+(\[.*\])?")
    cells = []
    for extra, needed in project["optional-dependencies"].items():
        packages = [match[0] for text in needed if (match := names.match(text))]
        cells.append((f"`{extra}`", ", ".join(packages)))
    return _table(("extra", "brings"), cells)


def effects() -> str:
    """Return a table of the effects of fits, with what is fitted of each."""
    cells = []
    for type_, entry in pl.registry().components["effect"].items():
        names = ", ".join(f"`{name}`" for name in quantities(entry.component))
        cells.append((f"`{type_}`", words_of_type(entry.component, type_), names))
    return _table(("effect", "in words", "fitted"), cells)


def readers() -> str:
    """Return a table of the files of which curves are read."""
    cells = []
    for type_, entry in pl.registry().components["reader"].items():
        reader: Any = entry.component
        suffixes = ", ".join(f"`{suffix}`" for suffix in reader.suffixes)
        needs = ", ".join(reader.libraries)
        cells.append((suffixes, entry.summary.rstrip("."), f"`{type_}`", needs))
    return _table(("files", "hold", "reader", "needs"), cells)


def failed_checks() -> str:
    """Return a table of the checks of the residuals of a fit."""
    return _table(("code", "it says"), [(f"`{flaw.name.lower()}`", flaw.value) for flaw in Flaw])


def studies() -> str:
    """Return a table of the files of docs/studies."""
    cells = []
    for path in sorted((ROOT / "docs/studies").glob("*.toml")):
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        runs = len(pl.Study.from_toml(path).points) if "study" in data else 1
        cells.append((f"[{path.stem}](studies/{path.name})", data["title"], str(runs)))
    return _table(("file", "title", "runs"), cells)


def rules_of_families() -> str:
    """Return what each family's components have to keep, as the kit asks it."""
    parts = []
    for family in [name for name in _HEADINGS if name != "effect"]:
        module = import_module(f"{testing.__name__}.{family}s")
        rules = [*CHEAP.get(family, ()), *testing.rules_of(module.__name__)]
        parts += [f"**{_HEADINGS[family]}**\n"]
        parts += [f"- {requirement_of(rule).partition('. ')[0].rstrip('.')}." for rule in rules]
        parts.append("")
    return "\n".join(parts)


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
        options_of_commands,
        functions,
        extras,
        effects,
        readers,
        failed_checks,
        studies,
        rules_of_families,
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
