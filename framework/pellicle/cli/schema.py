"""``pellicle schema``."""

from __future__ import annotations

from typing import Annotated

import typer

from pellicle.errors import ConfigError, PluginError
from pellicle.plugins.commands import file_models
from pellicle.plugins.origins import BrokenPlugin

from .printing import print_json


def schema(
    command: Annotated[
        str | None,
        typer.Argument(metavar="COMMAND", help="Command that takes a TOML file, such as run."),
    ] = None,
) -> None:
    """Print the JSON schema of a run or study file, with all installed components, for editors.

    With COMMAND, that of the file which the command takes.
    """
    from pellicle import json_schema as make_schema
    from pellicle.config.run import Run
    from pellicle.schema.messages import nearest

    models = file_models()
    if command is not None and command not in models:
        raise ConfigError(
            f"{command!r} is not a command that takes a TOML file; {nearest(command, models)}",
            "COMMAND",
        )
    model = Run if command is None else models[command]
    if isinstance(model, BrokenPlugin):
        raise PluginError(f"the file of command {command!r} is broken: {model}")
    print_json(make_schema(model))
