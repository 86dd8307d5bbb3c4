"""Runs on a cluster, by way of dask's distributed scheduler."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Annotated, Literal

from pydantic import Field

from pellicle import ConfigError, hookimpl
from pellicle.components import AnyTask, Executor, Outcome, Report, Say


class Dask(Executor):
    """Runs on the workers of a dask scheduler, on this machine or on a cluster.

    A run whose worker dies is begun again on another, and given up when four have died of it (the
    setting ``distributed.scheduler.allowed-failures`` is 3). Needs the extra ``cluster``, pellicle
    of one version on all workers, and a folder of the study that all of them see under the same
    path. A script that has no address needs ``if __name__ == "__main__":``.
    """

    type: Literal["dask"] = "dask"
    address: Annotated[
        str | None,
        Field(
            description='scheduler, as in "tcp://node1:8786"; if absent, one is started here, with '
            "workers of its own"
        ),
    ] = None
    workers: Annotated[
        int | None,
        Field(
            ge=1,
            description="processes of a scheduler that is started here; as many as fill the cores "
            "that we may use if absent",
        ),
    ] = None
    threads: Annotated[int, Field(ge=1, description="threads of each run's Fourier transforms")] = 1

    def map(
        self,
        work: Callable[[AnyTask, Say], Outcome],
        tasks: Sequence[AnyTask],
        report: Report[AnyTask],
    ) -> Iterator[tuple[AnyTask, Outcome | Exception]]:
        """Yield each task as it finishes; see `Executor.map`.

        Where the iterator is closed early, or this process dies, tasks at work on a scheduler that
        was not started here end when they next say something.

        Raises
        ------
        ConfigError
            The extra is not installed, or no scheduler answers.
        """
        if not tasks:
            return
        try:
            from .submission import Submission, cluster
        except ImportError as error:
            raise ConfigError(
                f"'dask' needs {error.name}, which is not installed; pip install "
                "'pellicle[cluster]'",
                "type",
            ) from None
        with (
            cluster(self.address, self.workers, self.threads) as client,
            Submission(client, work, tasks) as submission,
        ):
            yield from submission.outcomes(report)


@hookimpl
def register_executors(register: Callable[[type[Executor]], None]) -> None:
    """Register the executor."""
    register(Dask)
