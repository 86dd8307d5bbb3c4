"""A run that is interrupted leaves every finished step."""

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import pellicle as pl
from tests.command import call
from tests.framework.bad_input.conftest import says
from tests.framework.sentences.bad_files import START

# Where tests run in the background, their processes would ignore Ctrl-C.
LISTENING = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from pellicle.__main__ import main; main()"
)


@pytest.fixture
def long_run(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """Return a process that has written its first step and has many to go."""
    (tmp_path / "start.toml").write_text(START, encoding="utf-8")
    steps = "loading.depth={start='10 um', stop='20 um', num=20_000}"
    process = subprocess.Popen(
        [sys.executable, "-c", LISTENING, "run", "start.toml", "-o", "out", "--set", steps],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        patience = time.monotonic() + 60
        while not (tmp_path / "out/start.h5").exists():
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < patience, "no step in a minute"
            time.sleep(0.01)
        yield process
    finally:
        process.kill()
        process.communicate()


@pytest.mark.slow
def test_interrupt(tmp_path: Path, long_run: subprocess.Popen[str]) -> None:
    """Ctrl-C leaves every finished step, says where, and exits with 130."""
    long_run.send_signal(signal.SIGINT)
    message = long_run.communicate(timeout=60)[1]
    assert long_run.returncode == 130
    says(message, "interrupted; finished steps are in out")
    assert "Traceback" not in message
    done = pl.load(tmp_path / "out/start.h5").dataset
    assert 1 <= done.sizes["step"] < 20_000
    assert done["converged"].values.all()
    shown = call("show", tmp_path / "out/start.h5", code=1)
    assert f"interrupted: {done.sizes['step']} of 20000 steps" in shown.stderr
