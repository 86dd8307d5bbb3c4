"""The progress bars of a notebook: one output, updated, which goes when the work ends."""

from __future__ import annotations

import re
from html import unescape
from typing import Any

import pytest
import rich.console
from rich.table import Table

from pellicle.runs import bars, progress
from pellicle.runs.progress import BatchProgress, ProgressMessage, RunProgress, status_line
from tests.framework.test_progress import Job

ipython = pytest.importorskip("IPython.display")


class Cell(list[str]):
    """What the output of a cell showed, one text after the other."""

    def display(self, shown: Any, *, display_id: bool) -> Cell:
        """Show the first one; the cell is its own handle."""
        assert display_id
        assert not self, "a second output"
        self.update(shown)
        return self

    def update(self, shown: Any) -> None:
        text: str = shown._repr_html_() or "" if isinstance(shown, ipython.HTML) else plain(shown)
        self.append(" ".join(text.split()))


def plain(table: Table) -> str:
    """Return the text that a notebook shows of a table."""
    html: str = table._repr_mimebundle_([], [])["text/html"]
    return unescape(re.sub("<[^>]*>", "", html))


@pytest.fixture
def cell(monkeypatch: pytest.MonkeyPatch) -> Cell:
    """Return the cell of a notebook, in which every update is shown."""
    cell, console = Cell(), rich.console.Console(force_jupyter=True, stderr=True)
    monkeypatch.setattr(ipython, "display", cell.display)
    monkeypatch.setattr("rich.console.Console", lambda **_: console)
    monkeypatch.setattr(progress, "_BETWEEN_UPDATES", 0.0)
    monkeypatch.setattr(bars, "_BETWEEN_UPDATES", 0.0)
    monkeypatch.setattr(bars, "_BEFORE_SHOWN", 0.0)
    return cell


def test_a_run_has_one_live_bar(cell: Cell) -> None:
    """It shows the step, the iteration and the residual, and is empty at the end."""
    with RunProgress(2, True) as bar:
        bar(0)(3, 1e6)
        bar(1)(4, 1e3)
    first, second, last = cell
    assert first.startswith("step 1/2 ")
    assert second.startswith("step 2/2 ")
    assert "iteration 4 residual 1.0e+03 × tolerance time left" in second
    assert last == ""


def test_a_study_has_one_live_bar(cell: Cell, capfd: pytest.CaptureFixture[str]) -> None:
    """It counts runs, has a line for each run at work, and prints no line for each finished run."""
    job = Job("<b>tip</b>")
    with BatchProgress(3, 1, enabled=True) as bar:
        bar.report(job, ProgressMessage(1, 4, 7, 2e5, 1.5))
        assert "1 done, 0 failed, 2 left" in cell[-1]
        assert "<b>tip</b>" in cell[-1]
        assert "step 2/4 iteration 7" in cell[-1]
        bar.finished(job, "converged", failed=False)
        assert "2 done, 0 failed, 1 left" in cell[-1]
        assert "tip" not in cell[-1]
    assert cell[-1] == ""
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("enabled", [True, False])
def test_short_or_quiet_work_shows_nothing(
    cell: Cell, enabled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing flickers, and no empty output is left in the notebook."""
    if enabled:
        monkeypatch.setattr(bars, "_BEFORE_SHOWN", 3600.0)
    with RunProgress(2, enabled) as bar:
        bar(0)(3, 1e6)
    with BatchProgress(2, 0, enabled=enabled) as study:
        study.finished(Job("a"), "converged", failed=False)
    with status_line("fitting", enabled=enabled) as report:
        report("noise")
    assert cell == []
