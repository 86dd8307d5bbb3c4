"""Effects that pellicle does not ship, asked before a fit whether they keep their contract."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from pellicle import registry
from pellicle.errors import PluginError

from .effect import Effect


def refuse_broken(effects: Iterable[Effect]) -> None:
    """Ask strangers' effects the rules of the kit that balance no forces.

    Raises
    ------
    PluginError
        An effect breaks one of them.
    """
    shipped = {
        entry.component
        for entry in registry().components[Effect.family].values()
        if entry.origin.is_own
    }
    for effect in effects:
        if type(effect) not in shipped:
            _asked(effect)


@lru_cache(maxsize=64)
def _asked(effect: Effect) -> None:
    # The kit takes a second to import.
    from pellicle.testing import keep

    from .testing import QUICK

    try:
        keep(QUICK, effect)
    except AssertionError as error:
        broken = "; ".join(str(error).splitlines())
        raise PluginError(f"effect {effect.type_name!r}: {broken}") from error
