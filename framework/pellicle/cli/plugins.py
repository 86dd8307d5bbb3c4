"""``pellicle plugins``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Annotated

import typer

from pellicle.commands import claims_on, commands, file_models, typer_command
from pellicle.origins import Broken, Origin

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
    rows += _commands()
    broken = [
        {
            "entry_point": broken.origin.entry_point,
            "origin": broken.origin.distribution,
            "version": broken.origin.version,
            "error": broken.error,
        }
        for broken in (*contents.broken, *_broken_commands())
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


def _commands() -> Iterator[dict[str, str]]:
    """Yield a row for each command that can be used."""
    for name, (entry, *_) in commands().items():
        command, origin = typer_command(name), Origin.of(entry)
        if not isinstance(command, Broken):
            yield {
                "family": "command",
                "type": name,
                "origin": origin.distribution,
                "version": origin.version,
                "description": (command.help or "").partition("\n")[0],
            }


def _broken_commands() -> Iterable[Broken]:
    """Return what is wrong with commands, with their parameters and with the models of files."""
    claims = [claim for name in commands() for claim in (*claims_on(name), typer_command(name))]
    return dict.fromkeys(
        claim for claim in (*claims, *file_models().values()) if isinstance(claim, Broken)
    )
