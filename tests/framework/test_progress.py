"""The progress bar, and Ctrl-C while it is there."""

import io
import signal
import threading
from dataclasses import dataclass
from pathlib import Path

import pytest
import rich.console
from rich.console import Console

import pellicle as pl
from pellicle.runs.progress import BatchProgress, ProgressMessage, RunProgress
from tests import tables_of_runs

RUN = pl.Run(**tables_of_runs.RUN | {"title": "bead"})


@dataclass(frozen=True)
class Job:
    """A run of a study by its name."""

    name: str
    memory: int = 1


ONE, TWO = Job("kernel.tension = 1 N/m"), Job("kernel.tension = 2 N/m")


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    """Return what the terminal that the bars find is written, control codes included."""
    screen = io.StringIO()
    console = rich.console.Console(file=screen, force_terminal=True, width=200)
    monkeypatch.setattr("rich.console.Console", lambda **_: console)
    monkeypatch.setattr("pellicle.runs.progress._BETWEEN_UPDATES", 0.0)
    return screen


def lines(progress: BatchProgress, width: int = 200) -> list[str]:
    """Return what a terminal shows of the bars."""
    assert progress._bars
    paper = Console(file=io.StringIO(), width=width)
    with paper.capture() as capture:
        paper.print(progress._bars.get_renderable())
    return capture.get().splitlines()


def test_bar_on_a_terminal(screen: io.StringIO) -> None:
    """It shows step, iteration, residual and time left, and goes when the run ends."""
    with RunProgress(2, True) as progress:
        for index in range(2):
            monitor = progress(index)
            for iteration, excess in enumerate([1e6, 1e3, 0.5]):
                monitor(iteration, excess)
    shown = screen.getvalue()
    for words in ("step 2/2", "iteration 2", "residual 5.0e-01 × tolerance", "left"):
        assert words in shown
    assert shown.splitlines()[-1].endswith("\x1b[2K")


@pytest.mark.usefixtures("screen")
def test_a_study_has_a_line_for_each_run_at_work() -> None:
    """A run has a line from its first word to its end: its name, step and iteration."""
    with BatchProgress(3, 0, enabled=True) as progress:
        progress.report(ONE, ProgressMessage(0, 4, 3, 2e5, 0.25))
        progress.report(TWO, ProgressMessage(1, 2, 7, 3.0, 1.5))
        study, one, two = lines(progress)
        assert "0 done, 0 failed, 3 left" in study
        assert one.strip().startswith("kernel.tension = 1 N/m ")
        assert "step 1/4 iteration 3" in one
        assert "step 2/2 iteration 7" in two
        # Runs at work count by their share.
        assert progress._bars
        assert progress._bars.tasks[0].completed == 0.25 / 4 + 1.5 / 2
        progress.finished(ONE, "failed: struck by lightning", failed=True)
        study, two = lines(progress)
        assert "0 done, 1 failed, 2 left" in study
        assert "2 N/m" in two


@pytest.mark.usefixtures("screen")
def test_what_was_done_before_is_not_fast() -> None:
    """Tasks that an earlier call finished say nothing of the time that is left."""
    with BatchProgress(0, 0, True, "curves") as progress:
        assert progress._bars
        progress.expect(100, 0)
        progress.finished(ONE, "fitted", failed=False)
        progress.expect(100, 90)
        (task,) = progress._bars.tasks
        assert (task.description, task.completed, task.total) == ("curves", 91, 100)
        assert task.speed is None


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


@pytest.mark.usefixtures("screen")
@pytest.mark.parametrize("excess", [0.0, float("nan"), float("inf")])
def test_odd_residuals(excess: float) -> None:
    """A residual of zero, NaN or infinity does not end the run."""
    progress = RunProgress(1, True)
    with progress:
        monitor = progress(0)
        monitor(0, excess)
        monitor(1, 1.0)
        monitor(2, excess)


@pytest.mark.usefixtures("default_handler")
def test_interrupt_waits_for_the_next_iteration() -> None:
    """Ctrl-C takes effect at the next iteration, where nothing can swallow it."""
    with RunProgress(1, False) as progress:
        monitor = progress(0)
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            monitor(1, 1.0)
        monitor(2, 1.0)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.usefixtures("default_handler")
def test_second_interrupt_acts_at_once() -> None:
    """Pressing Ctrl-C again does not wait; one that comes too late is not forgotten."""
    with RunProgress(1, False) as progress:
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            progress(0)(0, 1.0)
    with pytest.raises(KeyboardInterrupt), RunProgress(1, False):
        signal.raise_signal(signal.SIGINT)


@pytest.mark.usefixtures("default_handler")
def test_interrupt_hides_no_error() -> None:
    """An error on the way out is not replaced by the interruption."""

    def fail() -> None:
        with RunProgress(1, False):
            signal.raise_signal(signal.SIGINT)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()


def test_interrupts_are_left_alone_where_they_are_not_ours() -> None:
    """In another thread, or under a handler of the caller's, nothing is changed."""

    def handle(*_: object) -> None:
        """Do nothing."""

    before = signal.signal(signal.SIGINT, handle)
    try:
        with RunProgress(1, False):
            assert signal.getsignal(signal.SIGINT) is handle
        assert signal.getsignal(signal.SIGINT) is handle
    finally:
        signal.signal(signal.SIGINT, before)
    seen: list[object] = []

    def work() -> None:
        with RunProgress(1, False):
            seen.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [before]


def test_a_function_is_called_at_each_iteration() -> None:
    """It gets the steps as the result counts them, and the iterations of each in order."""
    calls: list[tuple[int, int, float]] = []
    data = pl.run(RUN, progress=lambda *call: calls.append(call)).dataset
    for step, iterations in zip(data["step"].values, data["iterations"].values, strict=True):
        own = [call for call in calls if call[0] == step]
        assert [iteration for _, iteration, _ in own] == list(range(iterations + 1))
        assert own[-1][2] <= 1 < own[0][2]
    assert [step for step, *_ in calls] == sorted(step for step, *_ in calls)


@pytest.mark.parametrize("error", [ValueError("array is read-only"), pl.ConfigError("enough")])
def test_an_exception_of_the_function_ends_the_run(error: Exception, tmp_path: Path) -> None:
    """It passes through and blames no component; finished steps stay, and the next run resumes."""
    solved: set[int] = set()

    def end(step: int, iteration: int, residual: float) -> None:
        solved.add(step)
        if (step, iteration) == (3, 1):
            raise error

    with pytest.raises(type(error)) as raised:
        pl.run(RUN, directory=tmp_path, progress=end)
    assert raised.value is error
    assert error.__notes__ == ["raised by progress at iteration 1 of step 3"]
    assert list(pl.load(tmp_path / "bead.h5").dataset["step"]) == [1, 2]
    solved.clear()
    data = pl.run(RUN, directory=tmp_path, progress=lambda step, *_: solved.add(step)).dataset
    assert solved == {3}
    assert data.drop_vars("wall_time").equals(
        pl.run(RUN, progress=False).dataset.drop_vars("wall_time")
    )
