"""The progress bars of a notebook: one output, updated, which goes when the work ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pytest
import rich.console

from pellicle.runs import notebook_bar, progress
from pellicle.runs.progress import BatchProgress, ProgressMessage, RunProgress, status_line

ipython = pytest.importorskip("IPython.display")


@dataclass(frozen=True)
class Job:
    """A run by its name."""

    name: str
    memory: int = 1


class Cell(list[str]):
    """What the output of a cell showed, one HTML after the other."""

    def display(self, shown: Any, *, display_id: bool) -> Cell:
        """Show the first HTML; the cell is its own handle."""
        assert display_id
        assert not self, "a second output"
        self.append(shown.data)
        return self

    def update(self, shown: Any) -> None:
        """Replace it."""
        self.append(shown.data)


@pytest.fixture
def cell(monkeypatch: pytest.MonkeyPatch) -> Cell:
    """Return the cell of a notebook, in which every update is shown."""
    cell, console = Cell(), rich.console.Console(force_jupyter=True, stderr=True)
    monkeypatch.setattr(ipython, "display", cell.display)
    monkeypatch.setattr("rich.console.Console", lambda **_: console)
    monkeypatch.setattr(progress, "_BETWEEN_UPDATES", 0.0)
    monkeypatch.setattr(notebook_bar, "_BETWEEN_UPDATES", 0.0)
    monkeypatch.setattr(notebook_bar, "_BEFORE_SHOWN", 0.0)
    return cell


def test_a_run_has_one_live_bar(cell: Cell) -> None:
    """It shows the step, the iteration and the residual, and is empty at the end."""
    with RunProgress(2, True) as bar:
        bar.step(0)(3, 1e6)
        bar.step(1)(4, 1e3)
    first, second, last = cell
    assert "step 1/2 <progress max='2' value='0' " in first
    assert "step 2/2 <progress max='2' value='1' " in second
    assert "iteration 4 residual 1.0e+03 × tolerance" in second
    assert last == ""


def test_a_study_has_one_live_bar(cell: Cell, capfd: pytest.CaptureFixture[str]) -> None:
    """It counts runs, has a line for each run at work, and prints no line for each finished run."""
    job = Job("<b>tip</b>")
    with BatchProgress(3, 1, enabled=True) as bar:
        bar.report(job, ProgressMessage(1, 4, 7, 2e5, 1.5))
        assert "max='3' value='1.375'" in cell[-1]
        assert "&lt;b&gt;tip&lt;/b&gt; <progress max='4' value='1.5'" in cell[-1]
        bar.finished(job, "converged", failed=False)
        assert "2 done, 0 failed, 1 left" in cell[-1]
        assert "tip" not in cell[-1]
    assert cell[-1] == ""
    assert capfd.readouterr() == ("", "")


def test_a_fit_shows_its_stage(cell: Cell) -> None:
    """How long a fit takes is not known: the bar has no value."""
    with status_line("fitting", enabled=True) as report:
        report("noise")
        assert "fitting <progress style=" in cell[-1]
        assert "noise" in cell[-1]
    assert cell[-1] == ""


@pytest.mark.parametrize("enabled", [True, False])
def test_short_or_quiet_work_shows_nothing(
    cell: Cell, enabled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing flickers, and no empty output is left in the notebook."""
    if enabled:
        monkeypatch.setattr(notebook_bar, "_BEFORE_SHOWN", 3600.0)
    with RunProgress(2, enabled) as bar:
        bar.step(0)(3, 1e6)
    with BatchProgress(2, 0, enabled=enabled) as study:
        study.finished(Job("a"), "converged", failed=False)
    with status_line("fitting", enabled=enabled) as report:
        report("noise")
    assert cell == []
