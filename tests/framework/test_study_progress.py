"""The progress bar of a study: what is done, failed and left, and a line for each run at work."""

from __future__ import annotations

import errno
import io
import sys
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
        assert progress._bar is not None
        paper = Console(file=io.StringIO(), width=width)
        with paper.capture() as capture:
            paper.print(progress._bar.get_renderable())
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


def test_runs_done_failed_and_left(screen: Screen) -> None:
    """The line of the study counts runs; those done before count as done."""
    with BatchProgress(5, 1, enabled=True) as progress:
        (line,) = screen.lines(progress)
        assert line.startswith("runs")
        assert "1 done, 0 failed, 4 left" in line
        progress.finished(ONE, "converged", failed=False)
        progress.finished(TWO, "failed: struck by lightning", failed=True)
        (line,) = screen.lines(progress)
        assert "2 done, 1 failed, 2 left" in line


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
        progress.report(ONE, ProgressMessage(3, 4, 9, 1.0, 4.0))
        _, one, _ = screen.lines(progress)
        assert "step 4/4" in one
        progress.finished(ONE, "converged", failed=False)
        study, two = screen.lines(progress)
        assert "1 done, 0 failed, 2 left" in study
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


def test_time_left(screen: Screen) -> None:
    """It is that of the runs left at the pace so far; runs at work count by their share."""
    with BatchProgress(5, 1, enabled=True) as progress:
        progress.report(ONE, ProgressMessage(0, 2, 1, 1e3, 0.0))
        (line, _) = screen.lines(progress)
        assert "left -:--:--" in line
        for at, done in ((0.0, 0.02), (100.0, 1.02)):
            screen.now = at
            progress.report(ONE, ProgressMessage(0, 2, 1, 1e3, done))
        # Half a run in 100 s, so 200 s for each: of four, 0.51 are done.
        line, own = screen.lines(progress)
        assert f"left {_clock(200 * (4 - 0.51))}" in line
        assert f"left {_clock(100 * (2 - 1.02))}" in own
        screen.now = 200.0
        progress.finished(ONE, "converged", failed=False)
        (line,) = screen.lines(progress)
        assert f"left {_clock(3 * 200 / 0.99)}" in line


def _clock(seconds: float) -> str:
    whole = -int(-seconds // 1)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"


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


def test_silent_when_not_enabled(screen: Screen) -> None:
    """A bar that is not asked for writes nothing even on a terminal."""
    with BatchProgress(2, 0, enabled=False) as progress:
        progress.report(ONE, ProgressMessage(0, 1, 1, 1e3, 0.5))
        progress.finished(ONE, "converged", failed=False)
    assert screen.written() == ""


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "full"), BrokenPipeError(errno.EPIPE, "")])
def test_a_log_that_cannot_be_written_ends_no_study(
    error: OSError, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A full disk under the log, or a pipe that nobody reads, only loses the lines."""

    def write(text: str) -> int:
        raise error

    monkeypatch.setattr(sys, "stderr", log := io.StringIO())
    monkeypatch.setattr(log, "write", write)
    with BatchProgress(2, 0, enabled=True) as progress:
        progress.finished(ONE, "converged", failed=False)
        progress.finished(TWO, "converged", failed=False)
