"""The hooks that a plugin may implement, marked with `pellicle.hookimpl`."""

from __future__ import annotations

from collections.abc import Callable

import pluggy

from .components import Component, Suite

hookspec = pluggy.HookspecMarker("pellicle")
hookimpl = pluggy.HookimplMarker("pellicle")


@hookspec
def register_components(register: Callable[[type[Component]], None]) -> None:
    """Call ``register`` with each component class of the plugin, of any family."""


@hookspec
def register_validations(register: Callable[[Suite], None]) -> None:
    """Call ``register`` with a function that yields cases with known results for `validate`."""
