"""A client of a dask scheduler: one that is there, or one whose workers are jobs of a queue."""

from __future__ import annotations

import asyncio
import json
import shutil
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from dask import config
from distributed import Client, Security
from distributed.comm.core import connect

from pellicle import ConfigError


def client_of(address: str | None, file: Path | None, certificates: Any) -> Client:
    """Return a client of the scheduler at an address, or of the one that wrote a file.

    With certificates (``ca_file``, ``cert``, ``key``) they talk by TLS.
    """
    remedy = f"start `dask scheduler --scheduler-file {file and file.name}`"
    field, wrong, security = "scheduler_file", f"{file} holds no address", Security()
    try:
        if file:
            address = str(json.loads(file.read_text(encoding="utf-8"))["address"])
        if certificates:
            field, wrong, remedy = "security", "cannot be used", "give files in PEM"
            files = {
                "tls_ca_file": str(certificates.ca_file),
                "tls_client_cert": str(certificates.cert),
                "tls_client_key": str(certificates.key),
            }
            security = Security(require_encryption=True, **files)
        options = security.get_connection_args("client")
        field, wrong = "address", f"no scheduler answers at {address!r}"
        remedy = "give the address that `dask scheduler` prints, or use the executor "
        remedy += '"processes" on one machine'
        # In a thread: a notebook has a loop of its own.
        with ThreadPoolExecutor(1) as pool:
            pool.submit(asyncio.run, _reach(address, options)).result()
        return Client(address, security=security, set_as_default=False)
    except (OSError, ValueError, TypeError, KeyError, RuntimeError) as error:
        # So dask refuses an address with TLS without certificates, and the reverse.
        if field == "address" and isinstance(error, (TypeError, RuntimeError)):
            kind = "has no TLS; leave out" if certificates else "has TLS; give"
            message = f"the scheduler at {address!r} {kind} security"
            raise ConfigError(message, "security") from None
        reason = f" ({error})" if str(error) else ""
        raise ConfigError(f"{wrong}{reason}; {remedy}", field) from None


async def _reach(address: str | None, options: dict[str, Any]) -> None:
    """Connect once: a client that cannot is left half made, and takes a minute to end."""
    comm = await connect(address, **options)
    await comm.close()


def client_of_jobs(queue: str, jobs: int) -> AbstractContextManager[Client]:
    """Return a client of a scheduler here, whose workers are so many jobs of a batch system.

    All else about the jobs is in the configuration of dask-jobqueue, which is the user's own: it
    holds commands, and a run file may be a stranger's. The scheduler listens to other nodes, but
    lets in only who has the certificate that is made for it.
    """
    # distributed does not name it as what is missing.
    import_module("cryptography")
    name = "HTCondor" if queue == "htcondor" else queue.upper()
    cluster_class = getattr(import_module("dask_jobqueue"), f"{name}Cluster")
    command = cluster_class.job_cls.submit_command.split()[0]
    if not shutil.which(command):
        raise ConfigError(f"there is no {command} here; start on a login node", "cluster")
    # The web server of the scheduler has no TLS.
    options = {"dashboard": False, "dashboard_address": "127.0.0.1:0"}
    options |= config.get(f"jobqueue.{queue}.scheduler-options", None) or {}
    shared = config.get(f"jobqueue.{queue}.shared-temp-directory", None) or "~"
    return _started(
        cluster_class, jobs, security=True, scheduler_options=options, shared_temp_directory=shared
    )


@contextmanager
def _started(cluster_class: Any, jobs: int, **options: Any) -> Iterator[Client]:
    try:
        cluster = cluster_class(**options)
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        message = f"{' '.join(str(error).split())}; jobs are set in ~/.config/dask/jobqueue.yaml"
        raise ConfigError(message, "cluster") from None
    with cluster, Client(cluster, set_as_default=False) as client:
        # Unlike scale(), this replaces jobs that end at their walltime.
        cluster.adapt(minimum_jobs=jobs, maximum_jobs=jobs)
        yield client
