"""``pellicle explain``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated

import typer

from pellicle.commands import file_models
from pellicle.errors import PluginError
from pellicle.origins import Broken

from .printing import echo, print_columns, print_json

if TYPE_CHECKING:
    from pydantic import BaseModel


def explain(
    type_: Annotated[
        str | None,
        typer.Argument(
            metavar="TYPE",
            help="Type of a component, such as tensed_membrane; a family, such as kernel; or a "
            "table, such as grid, loading, study or run. Without it, all of these are listed.",
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Print the fields of a component or of a table, with unit, default, meaning and an example."""
    from pellicle.config.explain import explanations

    models = file_models()
    if isinstance(broken := models.get(type_ or ""), Broken):
        raise PluginError(f"the file of command {type_!r} is broken: {broken}")
    tables = {name: model for name, model in models.items() if not isinstance(model, Broken)}
    if type_ is None:
        _print_words(tables, json)
        return
    listed = explanations(type_, tables)
    if json:
        print_json([e._asdict() | {"fields": [row._asdict() for row in e.fields]} for e in listed])
        return
    for number, explanation in enumerate(listed):
        if number:
            echo("")
        origin = f", from {explanation.origin}" if explanation.origin else ""
        echo(f"{explanation.name} ({explanation.kind}{origin})")
        echo("")
        echo(explanation.text)
        rows = explanation.fields
        if rows:
            echo("")
            columns = [("field", [row.name for row in rows])]
            if explanation.kind == "family":
                columns = [("type", [row.name for row in rows])]
            else:
                columns += [
                    ("unit", [row.unit for row in rows]),
                    ("default", [row.default for row in rows]),
                ]
            print_columns([*columns, ("meaning", [row.meaning for row in rows])])
        if explanation.example:
            echo("")
            echo("example:")
            echo("")
            echo(explanation.example)


def _print_words(tables: Mapping[str, type[BaseModel]], json: bool) -> None:
    """Print the tables of run files, and the types of each family of components."""
    from pellicle.config.explain import words_by_kind

    words = words_by_kind(tables)
    if json:
        print_json(words)
        return
    columns = [("kind", list(words)), ("types", [", ".join(types) for types in words.values()])]
    print_columns(columns)
    echo("")
    echo(
        "one in full: pellicle explain TYPE; the types of a family in a line each: "
        "pellicle explain kernel"
    )
