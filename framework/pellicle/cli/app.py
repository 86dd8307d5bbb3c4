"""The command line: finds commands, and turns errors into messages and exit codes."""

from __future__ import annotations

import inspect
import sys
import traceback
import warnings
from collections.abc import Iterator, Mapping
from contextlib import nullcontext
from io import TextIOWrapper
from typing import Annotated, Any

import typer
from rich.markup import escape
from typer.core import TyperCommand, TyperGroup

from pellicle.errors import PellicleError, PluginError
from pellicle.plugins.commands import commands, errors_attributed_to, load_command, typer_command
from pellicle.plugins.origins import BrokenPlugin

from .printing import BAD_INPUT, CRASHED, INTERRUPTED, echo, only_json, print_warning

_FIRST = "run", "check"
_LAST = "explain", "plugins", "schema", "new", "show", "plot", "validate"
"""Commands before and after those of plugins in the help."""


def _named_by_use(parameters: list[Any]) -> list[Any]:
    """Replace the types of Python that help texts show by names of values; flags have none."""
    for parameter in parameters:
        if parameter.param_type_name == "argument":
            parameter.display_type_rich = lambda ctx: None
        elif parameter.metavar is None:
            is_flag = getattr(parameter, "is_flag", False)
            parameter.metavar = "" if is_flag else str(parameter.name).upper()
    return parameters


class _Command(TyperCommand):
    """A command whose help shows no types of Python, and which prints nothing beside its JSON."""

    def get_params(self, ctx: Any) -> list[Any]:
        return _named_by_use(super().get_params(ctx))

    def invoke(self, ctx: Any) -> Any:
        quiet = only_json() if ctx.params.get("json", self.name == "schema") else nullcontext()
        with errors_attributed_to(str(self.name)), quiet:
            return super().invoke(ctx)


class _Commands(Mapping[str, Any]):
    """The commands by name, in the order of the help; each is imported when it is asked for."""

    def __iter__(self) -> Iterator[str]:
        others = (name for name in commands() if name not in (*_FIRST, *_LAST))
        return iter([name for name in (*_FIRST, *others, *_LAST) if name in commands()])

    def __len__(self) -> int:
        return len(commands())

    def __getitem__(self, name: str) -> TyperCommand:
        command = load_command(name)
        if isinstance(command, BrokenPlugin):
            return _Listed(name, help=f"broken: {escape(command.error)}")
        return _Listed(name, help=inspect.getdoc(command.function))


class _Listed(TyperCommand):
    """A command as the help lists it; its parameters are read when it is called."""

    def make_context(self, *args: Any, **kwargs: Any) -> Any:
        command = typer_command(str(self.name), cls=_Command)
        if isinstance(command, BrokenPlugin):
            raise PluginError(f"command {self.name!r} is broken: {command}")
        return command.make_context(*args, **kwargs)


class _Group(TyperGroup):
    """Turns errors into one message and an exit code: bad input causes no traceback."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes | {"commands": _Commands()})

    def get_params(self, ctx: Any) -> list[Any]:
        return _named_by_use(super().get_params(ctx))

    def main(self, *args: Any, **kwargs: Any) -> Any:
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, TextIOWrapper):
                # What a code page lacks is a question mark, not an error.
                stream.reconfigure(errors="replace")
        try:
            return super().main(*args, **kwargs)
        except Exception:
            # Python would end with 1, which means that a step did not converge.
            echo(traceback.format_exc(), err=True)
            echo("error: this is a fault of pellicle; please report the lines above", err=True)
            sys.exit(CRASHED)

    def invoke(self, ctx: Any) -> Any:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = print_warning
                # A command prints what Python, started with -W error, would raise.
                warnings.simplefilter("default", UserWarning)
                return super().invoke(ctx)
        except PellicleError as error:
            for line in str(error).splitlines():
                # Options to type are a line of their own.
                echo(line if line.startswith("  -") else f"error: {line}", err=True)
            raise typer.Exit(BAD_INPUT) from None
        except BrokenPipeError:
            raise typer.Exit(BAD_INPUT) from None
        except Exception as error:
            # A call of a component adds a note that names the component at fault.
            if not (notes := getattr(error, "__notes__", ())):
                raise
            echo(f"error: {notes[0]}: {type(error).__name__}: {error}", err=True)
            raise typer.Exit(BAD_INPUT) from None
        except KeyboardInterrupt:
            echo("interrupted", err=True)
            raise typer.Exit(INTERRUPTED) from None


app = typer.Typer(
    cls=_Group,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Contact mechanics of soft solids under a tensed skin.",
)


def _print_version(requested: bool) -> None:
    if requested:
        from pellicle.version import CITATION, __version__

        echo(f"pellicle {__version__}")
        echo(f"to cite it: {CITATION}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            is_eager=True,
            callback=_print_version,
            help="Print the version and how to cite it.",
        ),
    ] = False,
) -> None:
    pass
