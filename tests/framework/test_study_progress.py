"""The progress bar of a study: what is done, failed and left, and a line for each run at work."""

from __future__ import annotations

import io
from dataclasses import dataclass

import pytest
from rich.console import Console

from pellicle.runs.progress import BatchProgress, ProgressMessage


@dataclass(frozen=True)
class Job:
    """A run by its name."""

    name: str
    memory: int = 1


ONE, TWO = Job("kernel.tension = 1 N/m"), Job("kernel.tension = 2 N/m")


class Screen:
    """A terminal with a clock that stands still unless it is set."""

    def __init__(self) -> None:
        self.now = 0.0
        self._file = io.StringIO()
        self._console = Console(
            file=self._file, force_terminal=True, width=200, get_time=lambda: self.now
        )

    def console(self, **_: object) -> Console:
        """Return itself, whichever console is asked for."""
        return self._console

    def lines(self, progress: BatchProgress, width: int = 200) -> list[str]:
        """Return what stands on it, or would on one of another width."""
        assert progress._bars
        paper = Console(file=io.StringIO(), width=width)
        with paper.capture() as capture:
            paper.print(progress._bars.get_renderable())
        return capture.get().splitlines()

    def written(self) -> str:
        """Return all that was ever written, control codes included."""
        return self._file.getvalue()


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> Screen:
    """Return the terminal that the bar finds."""
    screen = Screen()
    monkeypatch.setattr("rich.console.Console", screen.console)
    return screen


def test_one_line_for_each_run_at_work(screen: Screen) -> None:
    """A run has a line from its first word to its end: its name, step and iteration."""
    with BatchProgress(3, 0, enabled=True) as progress:
        progress.report(ONE, ProgressMessage(0, 4, 3, 2e5, 0.25))
        progress.report(TWO, ProgressMessage(1, 2, 7, 3.0, 1.5))
        study, one, two = screen.lines(progress)
        assert "0 done, 0 failed, 3 left" in study
        assert one.strip().startswith("kernel.tension = 1 N/m ")
        assert "step 1/4 iteration 3" in one
        assert two.strip().startswith("kernel.tension = 2 N/m ")
        assert "step 2/2 iteration 7" in two
        # Runs at work count by their share.
        assert progress._bars
        assert progress._bars.tasks[0].completed == 0.25 / 4 + 1.5 / 2
        progress.report(ONE, ProgressMessage(3, 4, 9, 1.0, 4.0))
        _, one, _ = screen.lines(progress)
        assert "step 4/4" in one
        progress.finished(ONE, "failed: struck by lightning", failed=True)
        study, two = screen.lines(progress)
        assert "0 done, 1 failed, 2 left" in study
        assert "2 N/m" in two


def test_narrow_terminal(screen: Screen) -> None:
    """Where there is no room for all it is the names that are cut, and nothing in them is lost."""
    job = Job("loading.depth = [1e-6, 2e-6], kernel.tension = 1 N/m, indenter.radius = 1 mm")
    with BatchProgress(1000, 100, enabled=True) as progress:
        progress.report(job, ProgressMessage(0, 4, 3, 2e5, 0.25))
        study, run = screen.lines(progress, width=80)
    assert "100 done, 0 failed, 900 left time left -:--:--" in " ".join(study.split())
    assert run.startswith("  loading.depth = [")
    assert "…" in run
    assert "step 1/4 iteration 3" in run
    assert max(len(study), len(run)) <= 80


def test_nothing_stays_on_the_terminal(screen: Screen) -> None:
    """The bar goes when the study ends, so that what is printed next stands in its place."""
    with BatchProgress(2, 0, enabled=True) as progress:
        progress.report(ONE, ProgressMessage(0, 1, 1, 1e3, 0.5))
    *_, last = screen.written().splitlines()
    assert last.endswith("\x1b[2K")


def test_a_log_has_a_line_for_each_run(capfd: pytest.CaptureFixture[str]) -> None:
    """Without a terminal there are no control codes, and nothing before a run is done."""
    long = Job(f"kernel.tension = {'1' * 200} [N/m]")
    with BatchProgress(7, 4, enabled=True) as progress:
        progress.report(ONE, ProgressMessage(0, 1, 1, 1e3, 0.5))
        assert capfd.readouterr() == ("", "")
        progress.finished(ONE, "converged", failed=False)
        progress.finished(long, "failed: [bold]no[/bold]", failed=True)
    out, err = capfd.readouterr()
    assert out == ""
    assert err.splitlines() == [
        "[5/7] kernel.tension = 1 N/m: converged",
        f"[6/7] {long.name}: failed: [bold]no[/bold]",
    ]
