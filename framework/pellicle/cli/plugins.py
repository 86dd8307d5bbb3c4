"""``pellicle plugins``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import typer

from pellicle.commands import commands, file_models, typer_command
from pellicle.origins import Broken, Origin, claimed_by

from .printing import echo, print_json, print_table


def plugins(json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False) -> None:
    """List the components that are installed, and what is broken and why."""
    from pellicle.plugins import registry

    contents = registry()
    owners = {name: [*map(Origin.of, entries)] for name, entries in commands().items()}
    made = {name: typer_command(name) for name in owners}
    installed = [
        (family, registered.type, registered.origin, registered.summary)
        for family, members in contents.components.items()
        for registered in members.values()
    ] + [
        ("command", name, owners[name][0], (command.help or "").partition("\n")[0])
        for name, command in made.items()
        if not isinstance(command, Broken)
    ]
    rows = [
        {
            "family": family,
            "type": type_,
            "origin": origin.distribution,
            "version": origin.version,
            "description": summary,
        }
        for family, type_, origin, summary in installed
    ]
    clashes: dict[tuple[str, str], Sequence[Origin]] = {
        **contents.clashes,
        **{("command", name): origins for name, origins in owners.items() if len(origins) > 1},
    }
    failed = {
        loaded.origin: loaded
        for name, loaded in (*file_models().items(), *made.items())
        if isinstance(loaded, Broken) and ("command", name) not in clashes
    }
    broken = [
        {
            "entry_point": broken.origin.entry_point,
            "origin": broken.origin.distribution,
            "version": broken.origin.version,
            "error": broken.error,
        }
        for broken in (*contents.broken, *failed.values())
    ] + [
        {
            "entry_point": f"{family}.{type_}",
            "origin": ", ".join(owner.distribution for owner in owners),
            "version": ", ".join(owner.version for owner in owners),
            "error": claimed_by(owners),
        }
        for (family, type_), owners in clashes.items()
    ]
    disabled = [str(origin) for origin in contents.disabled]
    if json:
        print_json({"components": rows, "broken": broken, "disabled": disabled})
        return
    print_table(["family", "type", "origin", "version", "description"], rows)
    if broken:
        echo("broken:")
        print_table(["entry_point", "origin", "version", "error"], broken)
    for origin in disabled:
        echo(f"switched off: {origin}")
