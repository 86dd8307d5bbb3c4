"""The hooks that a plugin may implement, marked with `pellicle.hookimpl`."""

from __future__ import annotations

from collections.abc import Callable

import pluggy

from .components import (
    AreaCorrection,
    Executor,
    Indenter,
    Interaction,
    Kernel,
    Output,
    Prescription,
    Solver,
    Suite,
)

hookspec = pluggy.HookspecMarker("pellicle")
hookimpl = pluggy.HookimplMarker("pellicle")


@hookspec
def register_kernels(register: Callable[[type[Kernel]], None]) -> None:
    """Call ``register`` with each kernel class of the plugin."""


@hookspec
def register_indenters(register: Callable[[type[Indenter]], None]) -> None:
    """Call ``register`` with each indenter class of the plugin."""


@hookspec
def register_interactions(register: Callable[[type[Interaction]], None]) -> None:
    """Call ``register`` with each interaction class of the plugin."""


@hookspec
def register_solvers(register: Callable[[type[Solver]], None]) -> None:
    """Call ``register`` with each solver class of the plugin."""


@hookspec
def register_corrections(register: Callable[[type[AreaCorrection]], None]) -> None:
    """Call ``register`` with each area correction class of the plugin."""


@hookspec
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Call ``register`` with each output class of the plugin."""


@hookspec
def register_executors(register: Callable[[type[Executor]], None]) -> None:
    """Call ``register`` with each executor class of the plugin."""


@hookspec
def register_prescriptions(register: Callable[[type[Prescription]], None]) -> None:
    """Call ``register`` with each prescription class of the plugin."""


@hookspec
def register_validations(register: Callable[[Suite], None]) -> None:
    """Call ``register`` with a function that yields cases with known results for `validate`."""
