"""Runs on a cluster through dask's distributed scheduler."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, Self

from pydantic import Field, model_validator

from pellicle import ConfigError
from pellicle.components import AnyTask, Executor, Outcome, Outcomes, Report, Threads, Work, Workers
from pellicle.schema import InputPath, Model


class Certificates(Model):
    """Files (PEM) with which this process and a scheduler with TLS know each other."""

    ca_file: InputPath = Field(description="certificate of the authority that signed all others")
    cert: InputPath = Field(description="own certificate")
    key: InputPath = Field(description="own private key")


class Dask(Executor):
    """Runs on the workers of a dask scheduler, on this machine or on a cluster.

    A run starts on a worker with threads and memory for it. If that dies, the run continues on
    another, where it is alone; it is abandoned after four such deaths (dask's ``allowed-failures``
    and one more). A worker at the end of its ``--lifetime`` has not died.
    This needs the extra ``cluster``, the same version of pellicle on all workers, and a study
    folder with the same path on all of them.
    """

    type: Literal["dask"] = "dask"
    examples = ({"address": "tcp://127.0.0.1:8786"},)
    address: str | None = Field(
        None,
        description='address of the scheduler, such as "tcp://node1:8786"; start one with '
        "`dask scheduler`, its workers with `dask worker ADDRESS`, or use the executor "
        '"processes" on one machine',
    )
    scheduler_file: InputPath | None = Field(
        None, description="file that `dask scheduler --scheduler-file` writes, instead of address"
    )
    security: Certificates | None = Field(
        None, description="certificates for a scheduler with TLS (tls://)"
    )
    cluster: Literal["slurm", "pbs", "sge", "lsf", "htcondor", "oar"] | None = Field(
        None,
        description="batch system that starts the workers as jobs, instead of address (extra "
        "`queue`); ~/.config/dask/jobqueue.yaml sets their cores, memory, walltime and queue",
    )
    jobs: Workers | None = Field(None, description="number of jobs at once, with cluster")
    threads: Threads = Field(
        1, description="threads of each run's arrays and transforms, out of those of its worker"
    )

    @model_validator(mode="after")
    def _check_sources(self) -> Self:
        given = [
            n for n in ("address", "scheduler_file", "cluster") if getattr(self, n) is not None
        ]
        if not given:
            words = type(self).model_fields["address"].description
            message = f"is missing; give it, scheduler_file or cluster: {words}"
            raise ConfigError(message, "address")
        if len(given) > 1 or bool(self.cluster) != bool(self.jobs):
            raise ValueError("give one of address, scheduler_file, and cluster together with jobs")
        if self.cluster and self.security:
            raise ValueError("a cluster makes its own certificates; leave out security")
        return self

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
            from .dask_client import client_of, client_of_jobs
            from .dask_tasks import Submission

            connection = (
                client_of_jobs(self.cluster, min(self.jobs, len(tasks)))
                if self.cluster and self.jobs
                else client_of(self.address, self.scheduler_file, self.security)
            )
        except ImportError as error:
            extra = "queue" if self.cluster else "cluster"
            raise ConfigError(
                f"'dask' needs {error.name}, which is not installed; pip install "
                f"'pellicle[{extra}]'",
                "type",
            ) from None
        with connection as client, Submission(client, work, tasks, self.threads) as submission:
            yield from submission.outcomes(report)
