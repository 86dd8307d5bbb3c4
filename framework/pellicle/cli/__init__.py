"""The command line, one file for each command; it only parses and prints.

Heavy imports are inside the commands, so that ``pellicle --help`` answers at once.
"""

from __future__ import annotations

import sys
import warnings
from typing import Any

import typer
from typer.core import TyperGroup

from pellicle.errors import PellicleError

from . import check, explore, fit, new, plot, plugins, run, schema, show, validate
from .encoding import encode_readably
from .exits import BAD_INPUT, INTERRUPTED
from .printing import print_warning


class _Group(TyperGroup):
    """Turns errors into one message and an exit code: no traceback reaches a user."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        for stream in (sys.stdout, sys.stderr):
            encode_readably(stream)
        return super().main(*args, **kwargs)

    def invoke(self, ctx: Any) -> Any:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = print_warning
                return super().invoke(ctx)
        except PellicleError as error:
            for line in str(error).splitlines():
                typer.echo(f"error: {line}", err=True)
            raise typer.Exit(BAD_INPUT) from None
        except Exception as error:
            # The orchestrator adds a note that names the component at fault.
            if not (notes := getattr(error, "__notes__", ())):
                raise
            typer.echo(f"error: {notes[0]}: {type(error).__name__}: {error}", err=True)
            raise typer.Exit(BAD_INPUT) from None
        except KeyboardInterrupt:
            typer.echo("interrupted", err=True)
            raise typer.Exit(INTERRUPTED) from None


app = typer.Typer(
    cls=_Group,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Contact mechanics of soft solids under a tensed skin.",
)

# In the order of the help.
for command in (
    run.run,
    check.check,
    explore.explore,
    fit.fit,
    plugins.plugins,
    schema.schema,
    new.new,
    show.show,
    plot.plot,
    validate.validate,
):
    app.command()(command)
