"""One process at a time writes the files of a run or of a study."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import pellicle as pl
from pellicle.runs.lock import locked
from tests.command import call
from tests.small_run import run_file

STUDY = run_file("[study.vary]\nkernel.reduced_modulus = ['10 kPa', '20 kPa']")


@contextmanager
def another_process(folder: Path, name: str) -> Iterator[subprocess.Popen[bytes]]:
    """Have another process lock files."""
    code = (
        "import sys, pathlib\nfrom pellicle.runs.lock import locked\n"
        "with locked(pathlib.Path(sys.argv[1]), sys.argv[2]):\n"
        "    print('locked', flush=True)\n    sys.stdin.read()"
    )
    holder = subprocess.Popen(
        [sys.executable, "-c", code, folder, name], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert holder.stdin is not None
    assert holder.stdout is not None
    try:
        assert holder.stdout.readline() == b"locked\n"
        yield holder
    finally:
        holder.kill()
        holder.wait()
        holder.stdin.close()
        holder.stdout.close()


@pytest.mark.parametrize(("text", "name"), [(run_file(), "work"), (STUDY, "study")])
def test_second_process_is_refused(text: str, name: str, tmp_path: Path) -> None:
    """A second run or study at the same files ends at once.

    The lock of a process that was killed is no hindrance, and no lock is left behind.
    """
    file, out = tmp_path / "work.toml", tmp_path / "out"
    file.write_text(text, encoding="utf-8")
    command = ["run", str(file), "-o", str(out), "-q"]
    with another_process(out, name) as holder:
        refused = call(*command, code=2)
        assert f"{out / name} is locked by another process" in refused.stderr.replace("\n", " ")
        assert [path.name for path in out.iterdir()] == [f".{name}.lock"]
        holder.send_signal(signal.SIGKILL)
        holder.wait()
        call(*command)
    assert not list(out.rglob("*.lock"))


def test_other_files_are_not_locked(tmp_path: Path) -> None:
    """Runs of another name in the same folder, and of the same name elsewhere, do not wait."""
    (tmp_path / "work.toml").write_text(run_file(), encoding="utf-8")
    with locked(tmp_path / "out", "other"), locked(tmp_path / "elsewhere", "work"):
        result = pl.run(tmp_path / "work.toml", directory=tmp_path / "out", progress=False)
    assert result.converged


def test_nothing_is_locked_where_nothing_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run without outputs leaves the folder alone."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "work.toml").write_text(run_file(), "utf-8")
    with locked(tmp_path, "work"):
        assert pl.run("work.toml", progress=False).converged


def test_lock_is_released(tmp_path: Path) -> None:
    """Files may be locked again by the same process, but not twice at once."""
    for _ in range(2):
        with (
            locked(tmp_path, "work"),
            pytest.raises(pl.StorageError, match="is locked by another process"),
            locked(tmp_path, "work"),
        ):
            raise AssertionError("locked twice")
    assert list(tmp_path.iterdir()) == []
