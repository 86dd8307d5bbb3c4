"""``pellicle plugins``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import typer

from pellicle.errors import ConfigError
from pellicle.plugins.commands import commands, file_models, typer_command
from pellicle.plugins.origins import BrokenPlugin, Origin, claimed_by

from .printing import NOT_CONVERGED, echo, print_json, print_table


def plugins(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME",
            help="With --check: a type, such as kernel.mine, a family or a distribution (default: "
            "all that pellicle does not ship).",
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    check: Annotated[
        bool, typer.Option("--check", help="Check components by the rules of their contract.")
    ] = False,
) -> None:
    """List the components that are installed, and what is broken and why."""
    from pellicle.components import Table
    from pellicle.components.installed import registry

    if check:
        _check(name, json)
        return
    if name is not None:
        raise ConfigError("is for --check alone", "NAME")
    contents = registry()
    owners = {name: [*map(Origin.of, entries)] for name, entries in commands().items()}
    loaded_commands = {name: typer_command(name) for name in owners}
    rows = [
        (family, type_, entry.origin.distribution, entry.origin.version, entry.summary)
        for family, members in contents.components.items()
        for type_, entry in members.items()
    ] + [
        ("command", name, of.distribution, of.version, (command.help or "").partition("\n")[0])
        for (name, (of, *_)), command in zip(owners.items(), loaded_commands.values(), strict=True)
        if not isinstance(command, BrokenPlugin)
    ]
    clashes: dict[tuple[str, str], Sequence[Origin]] = {
        **contents.clashes,
        **{("command", name): origins for name, origins in owners.items() if len(origins) > 1},
    }
    failed = {
        loaded.origin: loaded
        for name, loaded in (*file_models().items(), *loaded_commands.items())
        if isinstance(loaded, BrokenPlugin) and ("command", name) not in clashes
    }
    unusable = [
        (broken.origin.entry_point, [broken.origin], broken.error)
        for broken in (*contents.broken, *failed.values())
    ] + [(".".join(name), origins, claimed_by(origins)) for name, origins in clashes.items()]
    lost = [
        (name, ", ".join(o.distribution for o in of), ", ".join(o.version for o in of), error)
        for name, of, error in unusable
    ]
    components = Table.of_rows(("family", "type", "origin", "version", "description"), rows)
    broken = Table.of_rows(("entry_point", "origin", "version", "error"), lost)
    disabled = [str(origin) for origin in contents.disabled]
    if json:
        listed = {"components": components.records, "broken": broken.records}
        print_json(listed | {"disabled": disabled})
        return
    print_table(components)
    if lost:
        print_table(broken, "broken")
    for origin in disabled:
        echo(f"switched off: {origin}")


def _check(name: str | None, json: bool) -> None:
    """Check the examples of the components of a name; exit with 1 if one breaks its contract."""
    from pellicle.components import Table
    from pellicle.components.installed import registry
    from pellicle.testing.component import verdict_on_examples

    rows, all_hold = [], True
    for family, members in registry().components.items():
        for type_, registered in members.items():
            origin = registered.origin
            names = {family, type_, f"{family}.{type_}", origin.distribution}
            if name in names or (name is None and not origin.is_built_in):
                holds, verdict = verdict_on_examples(registered)
                all_hold = all_hold and holds
                rows.append((family, type_, origin.distribution, verdict))
    if name is not None and not rows:
        raise ConfigError(
            f"{name!r} is neither a type, a family nor a distribution of what is installed; see "
            "`pellicle plugins`",
            "NAME",
        )
    table = Table.of_rows(("family", "type", "origin", "verdict"), rows)
    if json:
        print_json(table.records)
    else:
        print_table(table)
    if not all_hold:
        raise typer.Exit(NOT_CONVERGED)
