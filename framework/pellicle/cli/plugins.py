"""``pellicle plugins``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import typer

from pellicle.commands import commands, file_models, typer_command
from pellicle.errors import ConfigError
from pellicle.origins import Broken, Origin, claimed_by

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
    from pellicle.plugins import registry

    if check:
        _check(name, json)
        return
    if name is not None:
        raise ConfigError("is for --check alone", "NAME")
    contents = registry()
    owners = {name: [*map(Origin.of, entries)] for name, entries in commands().items()}
    made = {name: typer_command(name) for name in owners}
    installed = [
        (family, type_, registered.origin, registered.summary)
        for family, members in contents.components.items()
        for type_, registered in members.items()
    ] + [
        ("command", name, owners[name][0], (command.help or "").partition("\n")[0])
        for name, command in made.items()
        if not isinstance(command, Broken)
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
    unusable = [
        (broken.origin.entry_point, [broken.origin], broken.error)
        for broken in (*contents.broken, *failed.values())
    ] + [(".".join(name), origins, claimed_by(origins)) for name, origins in clashes.items()]
    heads = "family", "type", "origin", "version", "description"
    rows = [
        dict(zip(heads, (family, type_, of.distribution, of.version, summary), strict=True))
        for family, type_, of, summary in installed
    ]
    broken = [
        {
            "entry_point": name,
            "origin": ", ".join(origin.distribution for origin in origins),
            "version": ", ".join(origin.version for origin in origins),
            "error": error,
        }
        for name, origins, error in unusable
    ]
    disabled = [str(origin) for origin in contents.disabled]
    if json:
        print_json({"components": rows, "broken": broken, "disabled": disabled})
        return
    print_table(heads, rows)
    if broken:
        echo("broken:")
        print_table(["entry_point", "origin", "version", "error"], broken)
    for origin in disabled:
        echo(f"switched off: {origin}")


def _check(name: str | None, json: bool) -> None:
    """Check the examples of the components of a name; exit with 1 if one breaks its contract."""
    from pellicle.plugins import registry
    from pellicle.testing.component import verdict_on_examples

    heads = "family", "type", "origin", "verdict"
    rows, kept = [], True
    for family, members in registry().components.items():
        for type_, registered in members.items():
            origin = registered.origin
            names = {family, type_, f"{family}.{type_}", origin.distribution}
            if name in names or (name is None and not origin.is_own):
                holds, verdict = verdict_on_examples(registered)
                kept = kept and holds
                cells = family, type_, origin.distribution, verdict
                rows.append(dict(zip(heads, cells, strict=True)))
    if name is not None and not rows:
        raise ConfigError(
            f"{name!r} is neither a type, a family nor a distribution of what is installed; see "
            "`pellicle plugins`",
            "NAME",
        )
    if json:
        print_json(rows)
    else:
        print_table(heads, rows)
    if not kept:
        raise typer.Exit(NOT_CONVERGED)
