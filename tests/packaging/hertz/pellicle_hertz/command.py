"""``pellicle hertz``."""

from pathlib import Path
from typing import Annotated

import typer

import pellicle as pl
from pellicle.cli import echo


def hertz(
    file: Annotated[Path, typer.Argument(help="TOML file with radius, modulus and depth.")],
) -> None:
    """Print the force on a rigid sphere in an elastic half-space."""
    from pellicle.units import readable
    from pellicle_hertz.contact import Contact

    echo(readable(Contact.from_toml(file).force, "N", 4))


@pl.hookimpl
def register_commands(register: pl.RegisterCommand) -> None:
    """Register the command."""
    register(hertz, file="pellicle_hertz.contact:Contact")
