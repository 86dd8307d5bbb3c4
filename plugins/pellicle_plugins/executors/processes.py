"""Several runs at once, each in a process of this machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Annotated, Literal

from pydantic import Field

from pellicle import hookimpl
from pellicle.components import AnyTask, Executor, Outcome, Report, Say, Threads, Workers


class Processes(Executor):
    """Several runs at once on this machine, as many as there are cores and memory for.

    A run starts when its estimated memory is free, so that large ones wait for each other; one that
    does not fit even alone fails and says so. A worker that dies loses its own run only. Ctrl-C
    ends all workers.
    """

    type: Literal["processes"] = "processes"
    workers: Annotated[
        Workers | None,
        Field(description="processes; as many as fill the cores that we may use if absent"),
    ] = None
    threads: Annotated[
        Threads, Field(description="threads of each run's Fourier transforms and linear algebra")
    ] = 1

    def map(
        self,
        work: Callable[[AnyTask, Say], Outcome],
        tasks: Sequence[AnyTask],
        report: Report[AnyTask],
    ) -> Iterator[tuple[AnyTask, Outcome | Exception]]:
        """Yield each task as it finishes; see `Executor.map`."""
        import loky

        from .process_pool import Crew

        most = self.workers or max(1, loky.cpu_count() // self.threads)
        with Crew(work, tasks, most, self.threads) as crew:
            started = crew.begin()
            while crew.busy or started:
                yield from started
                finished = crew.listen(report)
                # The workers get on before the caller looks at what is finished.
                started = [*finished, *crew.begin()]


@hookimpl
def register_executors(register: Callable[[type[Executor]], None]) -> None:
    """Register the executor."""
    register(Processes)
