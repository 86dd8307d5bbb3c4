"""Several runs at once, each in its own process on this machine."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from pydantic import Field

from pellicle.components import AnyTask, Executor, Outcome, Outcomes, Report, Threads, Work, Workers


class Processes(Executor):
    """Several runs at once on this machine, as many as there are cores and memory for.

    A run starts when its estimated memory is free, so large runs wait for each other; a run that
    does not fit even alone fails. If a worker dies, only its own run is lost. Ctrl-C ends all
    workers.
    """

    type: Literal["processes"] = "processes"
    examples = ({"workers": 2},)
    workers: Workers | None = Field(
        None, description="number of processes; if absent, enough to use all available cores"
    )
    threads: Threads = Field(
        1, description="threads of each run's arrays, transforms and linear algebra"
    )

    def map(
        self, work: Work[AnyTask, Outcome], tasks: Sequence[AnyTask], report: Report[AnyTask]
    ) -> Outcomes[AnyTask, Outcome]:
        """Yield each task as it finishes; see `Executor.map`."""
        import loky

        from .process_pool import ProcessPool

        workers = self.workers or max(1, loky.cpu_count() // self.threads)
        yield from ProcessPool(work, tasks, workers, self.threads).outcomes(report)
