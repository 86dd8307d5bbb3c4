"""The hooks that a plugin may implement, marked with `pellicle.hookimpl`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

import pluggy

from .origins import GROUP

if TYPE_CHECKING:
    from pellicle.components import Suite

    from .component import Component

hookspec = pluggy.HookspecMarker(GROUP)
hookimpl = pluggy.HookimplMarker(GROUP)


class RegisterCommand(Protocol):
    """Registers the command of an entry point ``command.NAME``."""

    def __call__(self, function: Callable[..., None], *, file: str = "", written: str = "") -> None:
        """Register a command.

        Parameters
        ----------
        function
            Its parameters are those of the command, as typer reads them; its documentation is the
            help. Its module imports typer alone; what is heavy is imported inside the function.
        file
            ``"package.module:Model"``, the model of the TOML file that the command takes. Folders
            ``examples/NAME/`` of the package hold examples of it for ``pellicle new --example``.
        written
            ``"package.module:function"``, which takes the path of a table that the command wrote
            by ``pellicle.results.write`` with NAME as its attribute ``command``, and returns an
            object with the methods ``show(*, si, json)``, which prints it, and ``plot(directory,
            formats)``, which draws it and returns files: `show` and `plot` of pellicle call them.
        """


@hookspec
def register_components(register: Callable[[type[Component]], None]) -> None:
    """Call ``register`` with each component class of the plugin, of any family."""


@hookspec
def register_validations(register: Callable[[Suite], None]) -> None:
    """Call ``register`` with a function that yields cases with known results for `validate`."""


@hookspec
def register_commands(register: RegisterCommand) -> None:
    """Call ``register`` with the function of the command, which the entry point names."""


def manager_of(plugin: object) -> pluggy.PluginManager:
    """Return a manager by which the hooks of one plugin, and no other, are called."""
    manager = pluggy.PluginManager(GROUP)
    manager.add_hookspecs(sys.modules[__name__])
    manager.register(plugin)
    return manager
