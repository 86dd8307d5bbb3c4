"""Carries out one task, whatever becomes of it."""

from __future__ import annotations

from collections.abc import Callable

from pellicle.components import AnyTask, Outcome, Say


def attempt(
    work: Callable[[AnyTask, Say], Outcome], task: AnyTask, say: Say
) -> Outcome | Exception:
    """Return what ``work(task, say)`` returns or raises; only an interruption passes through."""
    try:
        return work(task, say)
    except Exception as error:
        return error
    except SystemExit as error:
        return RuntimeError(f"{task.name}: its work left by sys.exit({error.code!r})")
