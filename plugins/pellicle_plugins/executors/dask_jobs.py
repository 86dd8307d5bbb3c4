"""A dask scheduler whose workers are jobs of a batch system."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import cryptography  # noqa: F401  (distributed does not name it as what is missing)
import dask_jobqueue
from dask import config
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


@contextmanager
def client_of_jobs(queue: str, jobs: int) -> Iterator[Client]:
    """Start a scheduler here, and so many jobs of a batch system as its workers.

    All else about the jobs is in the configuration of dask-jobqueue, which is the user's own: it
    holds commands, and a run file may be a stranger's. The scheduler listens to other nodes, but
    lets in only who has the certificate that is made for it.
    """
    cluster_class = getattr(dask_jobqueue, _CLASSES[queue])
    command = cluster_class.job_cls.submit_command.split()[0]
    if not shutil.which(command):
        raise ConfigError(
            f"there is no {command} here; start on a login node of the cluster", "cluster"
        )
    # The web server of the scheduler has no TLS.
    options = {"dashboard": False, "dashboard_address": "127.0.0.1:0"}
    options |= config.get(f"jobqueue.{queue}.scheduler-options", None) or {}
    shared = Path(config.get(f"jobqueue.{queue}.shared-temp-directory", None) or "~").expanduser()
    with ExitStack() as stack:
        try:
            folder = stack.enter_context(TemporaryDirectory(prefix=".pellicle-", dir=shared))
            security = _temporary_certificates(Path(folder))
            cluster = cluster_class(security=security, scheduler_options=options)
        except (OSError, ValueError, TypeError, RuntimeError) as error:
            reason = " ".join(str(error).split())
            raise ConfigError(
                f"{queue} cannot start jobs ({reason}); they are set in "
                f"~/.config/dask/jobqueue.yaml, at jobqueue: {queue}:",
                "cluster",
            ) from None
        stack.enter_context(cluster)
        client = stack.enter_context(Client(cluster, set_as_default=False))
        # Unlike scale(), this replaces jobs that end at their walltime.
        cluster.adapt(minimum_jobs=jobs, maximum_jobs=jobs)
        yield client


def _temporary_certificates(folder: Path) -> Security:
    """Return a certificate for all who can read a folder of this user, in files there."""
    made = Security.temporary()
    contents = {"cert": made.tls_client_cert, "key": made.tls_client_key}
    for name, content in contents.items():
        (folder / name).write_text(content, encoding="utf-8")
    roles = {
        f"tls_{role}_{name}": str(folder / name)
        for role in ("scheduler", "worker", "client")
        for name in contents
    }
    return Security(require_encryption=True, tls_ca_file=str(folder / "cert"), **roles)
