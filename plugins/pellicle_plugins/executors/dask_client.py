"""Clients of a dask scheduler that is there."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from distributed import Client, Security

from pellicle import ConfigError


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
