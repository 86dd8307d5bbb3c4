"""``pellicle explain``."""

from __future__ import annotations

from typing import Annotated

import typer

from pellicle.errors import PluginError
from pellicle.plugins.commands import file_models
from pellicle.plugins.origins import BrokenPlugin

from .printing import echo, print_json, print_table


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
    from pellicle.components import Column, Table
    from pellicle.config.explain import explanations, words_by_kind

    models = file_models()
    if isinstance(broken := models.get(type_ or ""), BrokenPlugin):
        raise PluginError(f"the file of command {type_!r} is broken: {broken}")
    tables = {name: model for name, model in models.items() if not isinstance(model, BrokenPlugin)}
    if type_ is None:
        words = words_by_kind(tables)
        if json:
            print_json(words)
            return
        types = [", ".join(names) for names in words.values()]
        print_table(Table([Column("kind", [*words]), Column("types", types)]))
        echo(
            "\none in full: pellicle explain TYPE; the types of a family in a line each: "
            "pellicle explain kernel"
        )
        return
    listed = explanations(type_, tables)
    if json:
        keys = "name", "kind", "unit", "default", "meaning"
        fields = [[{key: getattr(row, key) for key in keys} for row in e.fields] for e in listed]
        print_json([e._asdict() | {"fields": f} for e, f in zip(listed, fields, strict=True)])
        return
    for number, explanation in enumerate(listed):
        name, kind, origin, text, rows, example = explanation
        origin = f", from {origin}" if origin else ""
        echo("\n" * (number > 0) + f"{name} ({kind}{origin})\n\n{text}")
        if rows:
            heads = {"field": "name", "takes": "kind", "default": "default", "meaning": "meaning"}
            if kind == "family":
                heads = {"type": "name", "meaning": "meaning"}
            echo()
            columns = [Column(h, [getattr(row, key) for row in rows]) for h, key in heads.items()]
            print_table(Table(columns))
        if example:
            echo(f"\nexample:\n\n{example}")
