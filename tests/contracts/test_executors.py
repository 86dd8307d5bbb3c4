"""What our own executors keep beyond the contract: whatever tasks do, and however many wait."""

import sys
import threading
import time
from pathlib import Path
from typing import Any

import cloudpickle

from pellicle import ConfigError, Executor
from pellicle.components import Say
from tests.plugins.executors.jobs import Job, silence

# Workers cannot import a module of a folder that is no package.
cloudpickle.register_pickle_by_value(sys.modules[__name__])

WAITING = 60
"""Tasks that take longer, all of them, than it takes to close an executor."""
PATIENCE = 60.0


class FussyError(Exception):
    """Pickles, and cannot be read back."""

    def __init__(self, first: str, second: str) -> None:
        super().__init__(first + second)


def misbehave(job: Job, say: Say) -> Any:
    """Do at each of the first four jobs what a bad plugin might; wait for these at the others."""
    (job.folder / str(job.number)).touch()
    match job.number:
        case 0:
            raise ConfigError("it is odd", "job.number")
        case 1:
            raise SystemExit(3)
        case 2:
            return threading.Lock()
        case 3:
            raise FussyError("two ", "parts")
    end = time.monotonic() + PATIENCE
    while not all((job.folder / str(bad)).exists() for bad in range(4)):
        assert time.monotonic() < end
        time.sleep(0.01)
    time.sleep(0.02)
    return job.number


def test_whatever_tasks_do(executor: Executor, tmp_path: Path) -> None:
    """What is raised comes whole, and what cannot travel is said; closed early, the rest waits."""
    jobs = [Job(i, tmp_path) for i in range(4 + WAITING)]
    outcomes: Any = executor.map(misbehave, jobs, silence)
    values: dict[int, Any] = {}
    for job, outcome in outcomes:
        values[job.number] = outcome
        if values.keys() >= {0, 1, 2, 3}:
            break
    outcomes.close()
    begun = {int(path.name) for path in tmp_path.iterdir()}
    assert values.keys() >= {0, 1, 2, 3}
    assert values.keys() <= begun
    assert len(begun) < len(jobs)
    assert all(values[number] == number for number in values.keys() - {0, 1, 2, 3})
    assert isinstance(values[0], ConfigError)
    assert str(values[0]) == "job.number: it is odd"
    assert isinstance(values[1], Exception)
    assert "job 1" in str(values[1])
    if isinstance(values[2], Exception):
        assert "job 2" in str(values[2])
        assert "pickle" in str(values[2])
    else:
        assert isinstance(values[2], type(threading.Lock()))
    assert isinstance(values[3], Exception)
    assert "two parts" in str(values[3])
