"""Execute one task, in this or another process, and one after the other in this one."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from functools import partial
from typing import Any, Literal

import cloudpickle

from pellicle import PellicleError
from pellicle.components import AnyTask, Executor, Outcome, Outcomes, Report, Say, Work


def execute(work: Work[AnyTask, Outcome], task: AnyTask, say: Say) -> Outcome | Exception:
    """Return what ``work(task, say)`` returns, or the exception that it raises."""
    try:
        return work(task, say)
    except Exception as error:
        return error
    except SystemExit as error:
        return PellicleError(f"{task.name}: its work called sys.exit({error.code!r})")


def pack(work: Work[AnyTask, Outcome], task: AnyTask) -> bytes:
    """Return the payload for `execute_remotely`.

    cloudpickle sends definitions in scripts and notebooks by value, since workers cannot import
    them.
    """
    try:
        return bytes(cloudpickle.dumps((work, task)))
    except Exception as error:
        raise PellicleError(f"{task.name} does not pickle: {_line(error)}") from error


def execute_remotely(payload: bytes, say: Say) -> bytes:
    """Return the pickled outcome of a packed task; one that cannot be pickled is an error."""
    try:
        work, task = pickle.loads(payload)
    except Exception as error:
        message = f"a worker cannot read its task: {_line(error)}; what a run uses must be "
        return pickle.dumps(PellicleError(f"{message}installed where its worker is"))
    outcome: Any = execute(work, task, say)
    try:
        packed: bytes = cloudpickle.dumps(outcome)
        # Exceptions with their own arguments can often be pickled but not unpickled.
        pickle.loads(packed)
        return packed
    except Exception as error:
        message = f"{task.name}: its outcome does not pickle: {_line(error)}"
        if isinstance(outcome, Exception):
            message = _line(outcome)
        return pickle.dumps(PellicleError(message))


def _line(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


class Serial(Executor):
    """One run after the other, in this process."""

    type: Literal["serial"] = "serial"
    examples = ({"threads": 1},)

    def map(
        self, work: Work[AnyTask, Outcome], tasks: Sequence[AnyTask], report: Report[AnyTask]
    ) -> Outcomes[AnyTask, Outcome]:
        """Yield each task, in order, with what ``work`` returned or raised."""
        for task in tasks:
            yield task, execute(work, task, partial(report, task))
