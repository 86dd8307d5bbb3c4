"""``pellicle plugins``."""

from __future__ import annotations

from typing import Annotated

import typer

from .printing import echo, print_json, print_table


def plugins(json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False) -> None:
    """List the components that are installed, and what is broken and why."""
    from pellicle.plugins import registry

    contents = registry()
    rows = [
        {
            "family": family,
            "type": registered.type,
            "origin": registered.origin.distribution,
            "version": registered.origin.version,
            "description": registered.summary,
        }
        for family, members in contents.components.items()
        for registered in members.values()
    ]
    broken = [
        {
            "entry_point": broken.origin.entry_point,
            "origin": broken.origin.distribution,
            "version": broken.origin.version,
            "error": broken.error,
        }
        for broken in contents.broken
    ] + [
        {
            "entry_point": f"{family}.{type_}",
            "origin": ", ".join(owner.distribution for owner in owners),
            "version": ", ".join(owner.version for owner in owners),
            "error": f"claimed by {' and by '.join(map(str, owners))}",
        }
        for (family, type_), owners in contents.clashes.items()
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
