"""What scripts share: rows of a table, and measurements in processes of their own."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from inspect import getfile
from pathlib import Path
from typing import Any

_THREADS = "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"


def print_head(*names: str) -> None:
    """Print the heads of columns."""
    print_row(*names)
    print_row(*["---"] * len(names))


def print_row(*cells: object) -> None:
    """Print a row of a table in Markdown."""
    print("|", " | ".join(map(str, cells)), "|", flush=True)


def in_process(
    work: Callable[..., Any], *arguments: Any, threads: int = 1, timeout: float | None = None
) -> tuple[Any, str]:
    """Return what a function of a script returns in a process of its own, and what that logs.

    Arguments and results are what JSON knows; a RuntimeError has the log of a process that failed.
    """
    script = Path(getfile(work))
    code = (
        f"import json, sys; from {script.stem} import {work.__name__} as work; "
        "print(json.dumps(work(*json.load(sys.stdin))))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        input=json.dumps(arguments),
        capture_output=True,
        text=True,
        check=False,
        timeout=timeout,
        cwd=script.parent,
        env=os.environ | dict.fromkeys(_THREADS, str(threads)),
    )
    if done.returncode:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout.splitlines()[-1]), done.stderr
