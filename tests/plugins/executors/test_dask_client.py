"""How the executor dask finds its scheduler: a file, TLS, or jobs of a batch system."""

import gc
import re
import shutil
import stat
import subprocess
import sys
import warnings
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from dask import config as configuration

import pellicle as pl
from pellicle.schema.from_file import paths_relative_to
from tests.plugins.executors.jobs import Job, dask, silence, square
from tests.tables_of_runs import RUN

JOBS = [Job(i) for i in range(4)]
SBATCH = """#!/bin/sh
copy=$(mktemp -p {folder}); cp "$1" "$copy"
setsid bash "$copy" > {folder}/log 2>&1 < /dev/null &
echo "Submitted batch job $!"
"""


def squares(**fields: Any) -> dict[Job, Any]:
    """Return the squares of the numbers of all jobs, by the executor."""
    return dict(dask(**fields).map(square, JOBS, silence))


def refusal(folder: Path, **fields: Any) -> str:
    """Return why `pellicle run` does not use an executor: that, an exit code of 2, and no more."""
    changes = {"executor": {"type": "dask", **fields}, "vary": {"kernel.tension": [0, 1]}}
    (folder / "s.toml").write_text(tomli_w.dumps(RUN | {"study": changes}), encoding="utf-8")
    command = [sys.executable, "-m", "pellicle", "run", "s.toml"]
    # A client that is left half made takes a minute to end, and says so.
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120)
    (line,) = done.stderr.splitlines()
    assert done.returncode == 2
    return line


@pytest.fixture(scope="module")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Return the files of an authority, and of a certificate that it signed."""
    if not shutil.which("openssl"):
        pytest.skip("openssl is not installed")
    folder = tmp_path_factory.mktemp("tls")
    for command in (
        "req -x509 -newkey rsa:2048 -nodes -keyout ca.key -out ca.pem -days 2 -subj /CN=ca",
        "req -newkey rsa:2048 -nodes -keyout own.key -out own.csr -subj /CN=own",
        "x509 -req -in own.csr -CA ca.pem -CAkey ca.key -CAcreateserial -out own.pem -days 2",
    ):
        subprocess.run(["openssl", *command.split()], cwd=folder, check=True, capture_output=True)
    names = {"ca_file": "ca.pem", "cert": "own.pem", "key": "own.key"}
    return {field: str(folder / name) for field, name in names.items()}


@pytest.mark.slow
def test_scheduler_file(dask_address: str, tmp_path: Path) -> None:
    """The file that a scheduler writes, relative to the run file, stands for its address."""
    (tmp_path / "scheduler.json").write_text(f'{{"address": "{dask_address}"}}')
    with paths_relative_to(tmp_path):
        assert squares(scheduler_file="scheduler.json") == {job: job.number**2 for job in JOBS}


@pytest.mark.parametrize("text", [None, "", "[]", "{}"])
def test_no_scheduler_file(text: str | None, tmp_path: Path) -> None:
    """A file that is not there, or not one of a scheduler, is named, and who writes it."""
    path = tmp_path / "scheduler.json"
    if text is not None:
        path.write_text(text)
    with pytest.raises(pl.ConfigError, match=r"scheduler_file: .* --scheduler-file scheduler.json"):
        squares(scheduler_file=path)


@pytest.mark.slow
def test_tls(start_dask: Any, certificates: dict[str, str], tmp_path: Path) -> None:
    """Who has a certificate of the authority is let in; who has none is told to give it."""
    # What is first imported while settings are set loses its own when they end.
    pytest.importorskip("distributed")
    strange = {"ca_file": certificates["cert"], "cert": certificates["cert"]}
    settings = {"distributed.comm.tls.ca-file": certificates["ca_file"]}
    for role in ("scheduler", "worker", "client"):
        for kind in ("cert", "key"):
            settings[f"distributed.comm.tls.{role}.{kind}"] = certificates[kind]
    settings |= {"distributed.comm.default-scheme": "tls"}
    of_processes = {
        f"DASK_{name.upper().replace('.', '__').replace('-', '_')}": value
        for name, value in settings.items()
    }
    with ExitStack() as stack:
        with configuration.set(settings):
            address = stack.enter_context(start_dask(1, **of_processes))
        assert address.startswith("tls://")
        assert squares(address=address, security=certificates) == {j: j.number**2 for j in JOBS}
        assert re.search(r"security: .* has TLS; give security", refusal(tmp_path, address=address))
        told = refusal(tmp_path, address=address, security=certificates | strange)
        assert "address: no scheduler answers at 'tls://" in told


@pytest.mark.slow
def test_no_tls(dask_address: str, certificates: dict[str, str], tmp_path: Path) -> None:
    """What is to be encrypted is not sent as it is, and files that are no certificates are told."""
    told = refusal(tmp_path, address=dask_address, security=certificates)
    assert re.search(r"security: .* has no TLS; leave out security", told)
    told = refusal(tmp_path, address=dask_address.replace("tcp", "nothing"))
    assert "address: no scheduler answers at 'nothing://" in told
    for wrong in ("/nowhere.pem", __file__):
        with pytest.raises(pl.ConfigError, match="security: cannot be used"):
            squares(address=dask_address, security=certificates | {"cert": wrong})


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"address": "tcp://x:1", "cluster": "slurm", "jobs": 1}, "give one of address"),
        ({"cluster": "slurm"}, "cluster together with jobs"),
        ({"address": "tcp://x:1", "jobs": 2}, "cluster together with jobs"),
        ({"cluster": "slum", "jobs": 2}, "did you mean 'slurm'"),
    ],
)
def test_one_source_of_workers(fields: dict[str, Any], message: str) -> None:
    """An executor has one scheduler, and jobs only of a cluster."""
    with pytest.raises(pl.ConfigError, match=message):
        squares(**fields)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="has no batch system")
@pytest.mark.filterwarnings("ignore:unclosed cluster:ResourceWarning")
def test_jobs_of_a_batch_system(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Jobs are submitted, do the runs with TLS, and are gone afterwards, as are certificates.

    The batch system is two scripts that start and end processes here.
    """
    for module in ("dask_jobqueue", "cryptography"):
        pytest.importorskip(module, reason="not installed (pip install 'pellicle[queue]')")
    fields: dict[str, Any] = {"cluster": "slurm", "jobs": 2}
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    scripts = {"sbatch": SBATCH.format(folder=tmp_path), "scancel": '#!/bin/sh\nkill -- "-$1"\n'}
    options = {"cores": 1, "memory": "1GB", "scheduler-options": {"host": "127.0.0.1"}}
    options |= {"local-directory": str(tmp_path), "shared-temp-directory": str(tmp_path)}
    if not shutil.which("sbatch"):
        with pytest.raises(pl.ConfigError, match="cluster: there is no sbatch here"):
            squares(**fields)
    for name, script in scripts.items():
        (tmp_path / name).write_text(script)
        (tmp_path / name).chmod(stat.S_IRWXU)
    with pytest.raises(pl.ConfigError, match=r"(?s)cluster: .*cores.*jobqueue\.yaml"):
        squares(**fields)
    monkeypatch.setattr("pellicle_plugins.executors.dask_tasks._CHECK_INTERVAL", 60.0)
    with configuration.set({f"jobqueue.slurm.{name}": value for name, value in options.items()}):
        assert squares(**fields) == {job: job.number**2 for job in JOBS}
    with warnings.catch_warnings():
        # dask-jobqueue leaves it to the garbage collector to close them.
        warnings.simplefilter("ignore", ResourceWarning)
        gc.collect()
    assert "tls://" in (tmp_path / "log").read_text()
    assert not list(tmp_path.glob(".dask-jobqueue*"))
