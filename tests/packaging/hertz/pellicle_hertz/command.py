"""``pellicle hertz``."""

from pathlib import Path
from typing import Annotated

import typer

from pellicle.cli import Command, echo


def hertz(
    file: Annotated[Path, typer.Argument(help="TOML file with radius, modulus and depth.")],
) -> None:
    """Print the force on a rigid sphere in an elastic half-space."""
    from pellicle.units import readable
    from pellicle_hertz.contact import Contact

    echo(readable(Contact.from_toml(file).force, "N", 4))


COMMAND = Command(hertz, file="pellicle_hertz.contact:Contact")
