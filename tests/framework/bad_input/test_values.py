"""Bad values that no single command shows: memory, many at once, scales that lack a unit."""

from collections.abc import Callable
from typing import Any

import pytest

import pellicle as pl
from pellicle import memory
from pellicle.config.doubtful_scales import doubts_of_scale
from tests.framework.bad_input.conftest import says
from tests.tables_of_runs import pressing, tensed


def test_memory_is_estimated_before_starting(
    refuse: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A grid that needs more than there is left is refused with both numbers."""
    monkeypatch.setattr(memory, "available", lambda: 5e4)
    says(refuse(), "grid.points: 16 × 16 with 2 steps needs about", "5e-05 GB are available")


def test_memory_that_runs_out_all_the_same(
    refuse: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """An allocation that fails in spite of the estimate is no traceback."""

    def fail(*arguments: object) -> None:
        raise MemoryError

    monkeypatch.setattr("pellicle.runs.compose.operator_of", fail)
    says(refuse(), "grid.points: (16, 16) cells do not fit in memory; use fewer points")


def test_all_problems_at_once(refuse: Callable[..., str]) -> None:
    """Several problems are told together, a line each."""
    message = refuse("grid.points=0", "kernel.tension=-1", "loading={}", "kernel.colour=1")
    fields = [line.removeprefix("error: ").partition(":")[0] for line in message.splitlines()]
    assert sorted(fields) == ["grid.points", "kernel.colour", "kernel.tension", "loading"]


def test_long_values_are_cut(refuse: Callable[..., str]) -> None:
    """More digits than Python reads do not fill a screen."""
    message = refuse(f"grid.points={'9' * 5000}")
    says(message, "grid.points: '999")
    assert len(message) < 400


BEAD: dict[str, Any] = pressing(
    32, "50 um", tensed("4 kPa", "5 mN/m"), {"type": "sphere", "radius": "20 um"}, depth="1 um"
)


@pytest.mark.parametrize(
    ("table", "values", "message"),
    [
        ("kernel", {"tension": 50}, "kernel.tension is 50 N/m"),
        ("kernel", {"reduced_modulus": 4e-3}, "over the modulus 1.25 m"),
        ("indenter", {"radius": 20}, "indenter.radius is 20 m, on a domain of 50 µm"),
        ("loading", {"depth": 1}, "loading.depth is 1 m"),
        ("loading", {"depth": None, "force": 5}, "such as '5 nN'"),
        ("interaction", {"type": "jkr", "work_of_adhesion": 50}, "is 50 J/m²"),
    ],
)
def test_a_scale_that_lacks_a_unit(table: str, values: dict[str, Any], message: str) -> None:
    """A value out of scale with the others is doubted by name, and nothing else is."""
    changed = {**BEAD.get(table, {}), **values}
    given = {name: value for name, value in changed.items() if value is not None}
    ((path, text),) = doubts_of_scale(pl.Run(**{**BEAD, table: given})).items()
    assert path.startswith(f"{table}." if table != "kernel" else "kernel.tension")
    assert message in text


@pytest.mark.parametrize("scale", [1.0, 1e-6])
def test_plausible_scales_are_not_doubted(scale: float) -> None:
    """Neither are those of a study without dimensions, in which all values are about 1."""
    run = pl.Run(
        grid={"points": 32, "size": 4 * scale},
        kernel={"type": "tensed_membrane", "reduced_modulus": 1, "tension": 2 * scale},
        indenter={"type": "paraboloid", "radius": 10 * scale},
        loading={"force": [0.1 * scale**2, scale**2]},
        interaction={"type": "jkr", "work_of_adhesion": scale},
    )
    assert doubts_of_scale(run) == {}
    assert doubts_of_scale(pl.Run(**BEAD)) == {}


@pytest.mark.parametrize("solve", [pl.run, pl.run_study])
def test_the_library_warns_of_a_scale_as_the_command_does(
    solve: Any, recwarn: pytest.WarningsRecorder
) -> None:
    """A run, and a study for all of its runs, tell the value once, to the line that called."""
    run: dict[str, Any] = {**BEAD, "grid": {"points": 12, "size": "50 um"}, "outputs": []}
    run["kernel"] = {**BEAD["kernel"], "tension": 1000.0}
    if solve is pl.run_study:
        run["study"] = {"vary": {"kernel.tension": [0.005, 1000.0, 2000.0]}}
    solve(run, progress=False)
    (told,) = [entry for entry in recwarn if "is in SI" in str(entry.message)]
    assert str(told.message).startswith("kernel.tension is 1000 N/m")
    assert told.filename == __file__
