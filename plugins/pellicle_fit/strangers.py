"""Strangers' effects, asked before a fit; strangers' components, named where one fails."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from inspect import getsourcefile
from traceback import extract_tb

from pellicle import registry
from pellicle.errors import PellicleError, PluginError

from .effect import Effect


@lru_cache(maxsize=64)
def refuse_broken(effect: Effect) -> None:
    """Ask a stranger's effect the rules of the kit that balance no forces."""
    if type(effect) in registry().own:
        return
    # The kit takes a second to import.
    from pellicle.testing import keep

    from .testing.effects import QUICK

    try:
        keep(QUICK, effect)
    except AssertionError as error:
        broken = "; ".join(str(error).splitlines())
        raise PluginError(f"effect {effect.type_name!r}: {broken}") from None


@contextmanager
def name_strangers() -> Iterator[None]:
    """Add a note that names the stranger's component and its line to exceptions."""
    try:
        yield
    except PellicleError:
        raise
    except Exception as error:
        # The command line prints the note instead of a traceback.
        lines = {frame.filename: frame.lineno for frame in extract_tb(error.__traceback__)}
        for family, components in registry().components.items():
            for type_, entry in components.items():
                file = getsourcefile(entry.component)
                if file in lines and not entry.origin.is_built_in:
                    error.add_note(f"{family} {type_!r} failed ({file}, line {lines[file]})")
        raise
