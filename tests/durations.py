"""Stored CPU seconds of each test: they say which tests are quick and which file is the longest.

A row has a share of the fixtures that a test shares with others of its file: they would else fall
on the first that asks for them, which differs between selections.
"""

import csv
import os
import time
from collections import defaultdict
from collections.abc import Generator, Iterable
from pathlib import Path
from typing import Any

import pytest

STORED = Path(__file__).with_suffix(".csv")
ROOT = STORED.parents[1]
QUICK = 0.05
"""Mean CPU seconds of a case up to which a test is quick: with this, three quarters are."""


def function_of(nodeid: str) -> str:
    """Return the node id of a test without its case."""
    return nodeid.partition("[")[0]


def name_of(function: str) -> str:
    """Return the name of a test function without its file."""
    return function.rpartition("::")[2]


def stored() -> dict[str, float]:
    """Return the mean CPU seconds of a case of each stored test function."""
    with STORED.open(encoding="utf-8", newline="") as file:
        return {row["test"]: float(row["seconds"]) for row in csv.DictReader(file)}


def with_moved(rows: dict[str, float], functions: Iterable[str]) -> dict[str, float]:
    """Return rows of some functions; one that has moved to another file has its former row."""
    by_name = {name_of(row): seconds for row, seconds in rows.items()}
    found = {function: rows.get(function, by_name.get(name_of(function))) for function in functions}
    return {function: seconds for function, seconds in found.items() if seconds is not None}


def is_there(function: str) -> bool:
    """Whether a test function stands in its file, so that its row is worth keeping."""
    path = ROOT / function.partition("::")[0]
    return path.is_file() and f"def {name_of(function)}(" in path.read_text(encoding="utf-8")


class Durations:
    """A plugin of pytest that stores the CPU seconds of tests that passed and of their children."""

    def __init__(self) -> None:
        self.before = _cpu_seconds()
        self.fixtures: dict[str, float] = {}
        self.shared: dict[tuple[str, str], float] = {}
        self.users: dict[tuple[str, str], list[str]] = defaultdict(list)
        self.seconds: dict[str, dict[str, float]] = defaultdict(lambda: defaultdict(float))

    def pytest_runtest_logstart(self) -> None:
        self.before = _cpu_seconds()

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Generator[None, Any, Any]:
        """Measure a fixture that tests share, and leave it out of the phase that it falls in."""
        before = _cpu_seconds()
        value = yield
        if fixturedef.scope == "function":
            # Another file may share one of this name.
            self.fixtures.pop(fixturedef.argname, None)
        else:
            self.fixtures[fixturedef.argname] = seconds = _cpu_seconds() - before
            self.before += seconds
        return value

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(
        self, item: pytest.Function
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        """Note in the report of a phase its CPU seconds, and those of the fixtures it shares."""
        report = yield
        now = _cpu_seconds()
        report.cpu_seconds = now - self.before  # type: ignore[attr-defined]
        names = [name for name in item.fixturenames if name in self.fixtures]
        report.shared = {name: self.fixtures[name] for name in names}  # type: ignore[attr-defined]
        self.before = now
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Add up the phases of a test; pytest-xdist calls this in the process that started it."""
        if report.passed:
            cases = self.seconds[function_of(report.nodeid)]
            cases[report.nodeid] += report.cpu_seconds
            if report.when == "setup":
                for name, seconds in report.shared.items():
                    place = report.location[0], name
                    self.shared[place] = seconds
                    self.users[place].append(report.nodeid)

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Write the file anew, without tests that are gone; those not run keep their rows."""
        if hasattr(session.config, "workerinput"):
            return
        for place, seconds in self.shared.items():
            for nodeid in self.users[place]:
                self.seconds[function_of(nodeid)][nodeid] += seconds / len(self.users[place])
        measured = {test: sum(c.values()) / len(c) for test, c in self.seconds.items()}
        means = {test: mean for test, mean in stored().items() if is_there(test)} | measured
        with STORED.open("w", encoding="utf-8", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(["test", "seconds"])
            for test, mean in sorted(means.items()):
                rows.writerow([test, f"{mean:.3f}"])


def _cpu_seconds() -> float:
    children = os.times()[2:4]
    return time.process_time() + sum(children)
