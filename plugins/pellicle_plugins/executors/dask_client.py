"""Clients of a dask scheduler: one that is there, or one whose workers are jobs of a queue."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

import dask
from distributed import Client, Security

from pellicle import ConfigError

_CLASSES = {
    "slurm": "SLURMCluster",
    "pbs": "PBSCluster",
    "sge": "SGECluster",
    "lsf": "LSFCluster",
    "htcondor": "HTCondorCluster",
    "oar": "OARCluster",
}
"""Classes of dask_jobqueue by the names of their batch systems there."""


def address_in(scheduler_file: Path | None) -> str:
    """Return the address in the file that a scheduler wrote."""
    assert scheduler_file
    try:
        return str(json.loads(scheduler_file.read_text(encoding="utf-8"))["address"])
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise ConfigError(
            f"{scheduler_file} holds no address ({error}); start `dask scheduler "
            f"--scheduler-file {scheduler_file.name}`",
            "scheduler_file",
        ) from None


def client_of_scheduler(address: str, certificates: Any) -> Client:
    """Return a client of the scheduler at an address, by TLS if there are certificates."""
    security = None
    if certificates:
        security = Security(
            require_encryption=True,
            tls_ca_file=str(certificates.ca_file),
            tls_client_cert=str(certificates.cert),
            tls_client_key=str(certificates.key),
        )
        try:
            security.get_connection_args("client")
        except OSError as error:
            raise ConfigError(f"cannot be used ({error}); give files in PEM", "security") from None
    try:
        return Client(address, security=security, set_as_default=False)
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        # Without certificates, and with them, dask refuses the other kind by these two.
        if isinstance(error, (TypeError, RuntimeError)):
            kind = "has no TLS; leave out" if certificates else "has TLS; give"
            raise ConfigError(f"the scheduler at {address!r} {kind} security", "security") from None
        raise ConfigError(
            f"no scheduler answers at {address!r} ({error}); give the address that `dask "
            'scheduler` prints, or use the executor "processes" on one machine',
            "address",
        ) from None


@contextmanager
def _client_of(cluster: Any, jobs: int) -> Iterator[Client]:
    with cluster, Client(cluster, set_as_default=False) as client:
        # Unlike scale(), this replaces jobs that end at their walltime.
        cluster.adapt(minimum_jobs=jobs, maximum_jobs=jobs)
        yield client


def client_of_jobs(queue: str, jobs: int) -> Any:
    """Return a context: a client of an own scheduler, and so many jobs of a queue for its workers.

    All else about the jobs is in the configuration of dask-jobqueue, which is the user's own, not
    in a run file, which may be a stranger's: it may hold commands. The scheduler listens to other
    nodes, so it lets only those in that have its certificate, which is made for this run.
    """
    # Security.temporary() does not name it as the module that is missing.
    import_module("cryptography")
    jobqueue = import_module("dask_jobqueue")
    options = dask.config.get(f"jobqueue.{queue}.scheduler-options", None) or {}
    shared = dask.config.get(f"jobqueue.{queue}.shared-temp-directory", None)
    cluster_class = getattr(jobqueue, _CLASSES[queue])
    command = cluster_class.job_cls.submit_command.split()[0]
    if not shutil.which(command):
        raise ConfigError(
            f"there is no {command} here; start on a login node of the cluster", "cluster"
        )
    try:
        cluster = cluster_class(
            security=True,
            scheduler_options=options | {"dashboard": False},
            shared_temp_directory=shared or str(Path.home()),
        )
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        raise ConfigError(
            f"{error}; settings of jobs are in ~/.config/dask/jobqueue.yaml, jobqueue: {queue}:",
            "cluster",
        ) from None
    return _client_of(cluster, jobs)
