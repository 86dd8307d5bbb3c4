"""Numbers of threads that are none are refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.plugins import registry
from tests.framework.broken_contracts.short_run import GRID, study

NO_THREADS = [0, -1, 1.5, 2.0, "2", True, np.float64(2), [2], np.array([1, 2])]


@pytest.mark.parametrize("threads", NO_THREADS, ids=repr)
def test_threads_are_a_whole_number(threads: Any, tmp_path: Path) -> None:
    """Anything but None or a whole number ≥ 1 is refused in words, and nothing is computed."""
    configuration = pl.Run(
        grid=GRID,
        kernel={"type": "half_space", "reduced_modulus": 1e4},
        indenter={"type": "paraboloid", "radius": "1 mm"},
        loading={"depth": "2 um"},
    )
    for use in (
        lambda: pl.run(configuration, directory=tmp_path, progress=False, threads=threads),
        lambda: pl.run_study(study(), tmp_path, progress=False, threads=threads),
    ):
        with pytest.raises(pl.ConfigError, match=r"threads: .* whole number of threads, 1 to"):
            use()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("type_", ["serial", "processes", "dask"])
@pytest.mark.parametrize("threads", [0, -1, 1.5, "2", True], ids=repr)
def test_threads_of_an_executor_are_a_whole_number(type_: str, threads: Any) -> None:
    """The field says the same as the argument, in a file too."""
    address = {"address": "tcp://127.0.0.1:8786"} if type_ == "dask" else {}
    with pytest.raises(pl.ConfigError, match=r"threads: .* whole number of threads, 1 to"):
        registry().make(pl.Executor, {"type": type_, "threads": threads, **address})


def test_threads_of_numpy_are_taken() -> None:
    """A whole number of numpy is as good as one of Python."""
    result = pl.run(
        pl.Run(
            grid=GRID,
            kernel={"type": "half_space", "reduced_modulus": 1e4},
            indenter={"type": "paraboloid", "radius": "1 mm"},
            loading={"depth": "2 um"},
        ),
        progress=False,
        threads=np.int64(1),  # type: ignore[arg-type]
    )
    assert result.converged
    executor = registry().make(pl.Executor, {"type": "serial", "threads": np.int64(2)})
    assert executor.threads == 2
