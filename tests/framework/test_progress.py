"""The progress bar, and Ctrl-C while it is there."""

from __future__ import annotations

import io
import signal
import threading

import pytest
import rich.console

from pellicle.runs.progress import RunProgress


def _iterate(progress: RunProgress) -> None:
    with progress:
        for index in range(2):
            monitor = progress.step(index)
            for iteration, excess in enumerate([1e6, 1e3, 0.5]):
                monitor(iteration, excess)


@pytest.mark.parametrize("enabled", [True, False])
def test_silent_without_a_terminal(enabled: bool, capfd: pytest.CaptureFixture[str]) -> None:
    """Where there is no terminal nothing at all is written."""
    _iterate(RunProgress(2, enabled))
    assert capfd.readouterr() == ("", "")


def test_bar_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a terminal the bar shows step, iteration, residual and time left."""
    screen = io.StringIO()
    console = rich.console.Console(file=screen, force_terminal=True, width=200)
    monkeypatch.setattr("rich.console.Console", lambda **options: console)
    monkeypatch.setattr("pellicle.runs.progress._BETWEEN_UPDATES", 0.0)
    _iterate(RunProgress(2, enabled=True))
    shown = screen.getvalue()
    for words in ("step 2/2", "iteration 2", "residual 5.0e-01 × tolerance", "left"):
        assert words in shown


def test_silent_on_a_terminal_when_not_enabled(monkeypatch: pytest.MonkeyPatch) -> None:
    """A bar that is not asked for is not even made."""

    def fail() -> None:
        raise AssertionError("made a bar")

    monkeypatch.setattr("pellicle.runs.progress._make_bar", fail)
    _iterate(RunProgress(2, enabled=False))


@pytest.mark.parametrize("excess", [0.0, float("nan"), float("inf")])
def test_odd_residuals(excess: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """A residual of zero, NaN or infinity does not end the run."""
    console = rich.console.Console(file=io.StringIO(), force_terminal=True)
    monkeypatch.setattr("rich.console.Console", lambda **options: console)
    monkeypatch.setattr("pellicle.runs.progress._BETWEEN_UPDATES", 0.0)
    progress = RunProgress(1, enabled=True)
    with progress:
        monitor = progress.step(0)
        monitor(0, excess)
        monitor(1, 1.0)
        monitor(2, excess)


@pytest.mark.usefixtures("default_handler")
def test_interrupt_waits_for_the_next_iteration() -> None:
    """Ctrl-C takes effect at the next iteration, where nothing can swallow it."""
    with RunProgress(1, enabled=False) as progress:
        monitor = progress.step(0)
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            monitor(1, 1.0)
        monitor(2, 1.0)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.usefixtures("default_handler")
def test_second_interrupt_acts_at_once() -> None:
    """Pressing Ctrl-C again does not wait."""
    with RunProgress(1, enabled=False) as progress:
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            progress.step(0)(0, 1.0)


@pytest.mark.usefixtures("default_handler")
def test_interrupt_after_the_last_iteration() -> None:
    """Ctrl-C that comes too late for an iteration is not forgotten."""
    with pytest.raises(KeyboardInterrupt), RunProgress(1, enabled=False):
        signal.raise_signal(signal.SIGINT)


@pytest.mark.usefixtures("default_handler")
def test_interrupt_hides_no_error() -> None:
    """An error on the way out is not replaced by the interruption."""

    def fail() -> None:
        with RunProgress(1, enabled=False):
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
        with RunProgress(1, enabled=False):
            assert signal.getsignal(signal.SIGINT) is handle
        assert signal.getsignal(signal.SIGINT) is handle
    finally:
        signal.signal(signal.SIGINT, before)
    seen: list[object] = []

    def work() -> None:
        with RunProgress(1, enabled=False):
            seen.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [before]
