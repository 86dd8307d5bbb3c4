"""Carries out one task, whatever becomes of it, here or in another process."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any

import cloudpickle

from pellicle import PellicleError
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
        return PellicleError(f"{task.name}: its work left by sys.exit({error.code!r})")


def pack(work: Callable[[AnyTask, Say], Outcome], task: AnyTask) -> bytes:
    """Return what `attempt_far` takes.

    cloudpickle sends what scripts and notebooks define, which a worker cannot import, by value.

    Raises
    ------
    PellicleError
        It does not pickle.
    """
    try:
        parcel: bytes = cloudpickle.dumps((work, task))
    except Exception as error:
        raise PellicleError(f"{task.name} does not pickle: {_line(error)}") from error
    return parcel


def attempt_far(parcel: bytes, say: Say) -> bytes:
    """Return the pickled outcome of a packed task, whatever of it does not pickle."""
    try:
        work, task = pickle.loads(parcel)
    except Exception as error:
        return pickle.dumps(
            PellicleError(
                f"a worker cannot read its task: {_line(error)}; what a run uses must be installed "
                "where its worker is"
            )
        )
    return _packed(attempt(work, task, say), task.name)


def _packed(outcome: Any, name: str) -> bytes:
    try:
        packed: bytes = cloudpickle.dumps(outcome)
        # Exceptions with arguments of their own often pickle, and cannot be made again.
        pickle.loads(packed)
    except Exception as error:
        if isinstance(outcome, Exception):
            return pickle.dumps(PellicleError(_line(outcome)))
        return pickle.dumps(PellicleError(f"{name}: its outcome does not pickle: {_line(error)}"))
    return packed


def _line(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"
