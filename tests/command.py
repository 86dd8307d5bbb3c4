"""The command line, called in this process, and its parts in others, killed at random."""

import os
import random
import signal
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from typer.testing import CliRunner, Result

from pellicle.cli.app import app
from pellicle.cli.printing import CRASHED

Cli = Callable[..., Result]


def call(*words: object, code: int = 0, **environment: str) -> Result:
    """Return what a command has done; its exit code has to be ``code``."""
    done = CliRunner().invoke(app, [*map(str, words)], prog_name="pellicle", env=environment)
    # Anything but an exit would be a traceback on the user's screen.
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    assert done.exit_code == code, done.output
    assert code == CRASHED or "Traceback" not in done.output
    return done


def run_parts(command: list[str], count: int, folder: Path, *, kills: int) -> int:
    """Run each of ``count`` parts until it ends by itself; return the number of kills.

    Every process of the first ``kills`` parts is killed once, after up to 4 s.
    """
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    chance = random.Random(7)
    after = [chance.uniform(1.0, 4.0) if part < kills else None for part in range(count)]

    def run(part: int) -> int:
        own = [sys.executable, "-m", "pellicle", *command, "--part", f"{part + 1}/{count}"]
        process = subprocess.Popen(own, cwd=folder, env=environment, stdout=subprocess.DEVNULL)
        killed = 0
        try:
            assert process.wait(after[part]) == 0
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.wait()
            killed = 1
            subprocess.run(own, cwd=folder, env=environment, stdout=subprocess.DEVNULL, check=True)
        return killed

    with ThreadPoolExecutor(2) as pool:
        return sum(pool.map(run, range(count)))
