"""The contract of an installed component, over the examples of its class."""

from __future__ import annotations

import importlib

from pellicle.plugins import Registered


def verdict_on_examples(registered: Registered) -> tuple[bool, str]:
    """Return whether the examples of a component keep its contract, and in words how far.

    Without examples only what registration requires of the class has been checked.
    """
    family = registered.component.family
    kit = getattr(importlib.import_module(__package__), f"check_{family}", None)
    if kit is None or not registered.examples:
        lack = "examples" if kit else f"checks of the family {family!r}"
        return True, f"class rules only: there are no {lack}"
    for number, example in enumerate(registered.examples, start=1):
        try:
            kit(registered.component(**example))
        except Exception as error:
            return False, f"example {number}: {error}"
    return True, "keeps its contract"
