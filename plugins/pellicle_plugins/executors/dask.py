"""Runs on a cluster through dask's distributed scheduler."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from pydantic import Field

from pellicle import ConfigError
from pellicle.components import AnyTask, Executor, Outcome, Outcomes, Report, Threads, Work


class Dask(Executor):
    """Runs on the workers of a dask scheduler, on this machine or on a cluster.

    A run whose worker dies starts again on another. After four deaths (dask's
    ``allowed-failures`` and one more) it is tried once more, alone, and abandoned after four more.
    This needs the extra ``cluster``, the same version of pellicle on all workers, and a study
    folder with the same path on all of them.
    """

    type: Literal["dask"] = "dask"
    examples = ({"address": "tcp://127.0.0.1:8786"},)
    address: str = Field(
        description='address of the scheduler, such as "tcp://node1:8786"; start one with '
        "`dask scheduler`, its workers with `dask worker ADDRESS`, or use the executor "
        '"processes" on one machine'
    )
    threads: Threads = Field(1, description="threads of each run's arrays and transforms")

    def map(
        self, work: Work[AnyTask, Outcome], tasks: Sequence[AnyTask], report: Report[AnyTask]
    ) -> Outcomes[AnyTask, Outcome]:
        """Yield each task as it finishes; see `Executor.map`.

        If the iterator is closed early, running tasks end at their next report, for which this
        waits up to 10 s. They also end if this process dies.
        """
        if not tasks:
            return
        try:
            from distributed import Client

            from .dask_tasks import Submission
        except ImportError as error:
            raise ConfigError(
                f"'dask' needs {error.name}, which is not installed; pip install "
                "'pellicle[cluster]'",
                "type",
            ) from None
        try:
            client = Client(self.address, set_as_default=False)
        except (OSError, ValueError) as error:
            raise ConfigError(
                f"no scheduler answers at {self.address!r} ({error}); give the address that `dask "
                'scheduler` prints, or use the executor "processes" on one machine',
                "address",
            ) from None
        with client, Submission(client, work, tasks, self.threads) as submission:
            yield from submission.outcomes(report)
