"""The contract of outputs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, ClassVar, Literal, Protocol

from pellicle.arrays import DataArray, Dataset
from pellicle.checks import component_name
from pellicle.errors import PluginError
from pellicle.plugins.component import Component

from .charts import Shown


class Runs(Protocol):
    """A run or a study: a table of numbers, and the fields of each run, read when needed."""

    @property
    def table(self) -> Dataset:
        """Numbers of each run and step, over ``step`` and, in a study, over its axes.

        The variable ``run`` names the runs; numbers of missing steps are NaN. Where there is an
        interaction, variables of kind ``path`` have one value for each run.
        """

    @property
    def configuration(self) -> str:
        """The run or study as JSON in SI, with paths as they were given."""

    @property
    def axes(self) -> tuple[str, ...] | None:
        """The dimensions of a study; None for a run."""

    def open(self, name: str = "") -> Dataset:
        """Return all numbers and fields of a run, given its name in the table of a study.

        A file that does not exist or cannot be read is a StorageError.
        """

    def datasets(self) -> Iterator[tuple[tuple[int, ...], Dataset | None]]:
        """Yield the index in the table and the dataset of each run; None for a missing file."""

    def column(self, text: str) -> DataArray:
        """Return the value of an expression for each step; fields in it have to be reduced.

        A text that is not arithmetic, or names an unknown variable, is a ConfigError.
        """

    def from_each(self, function: Callable[[Dataset], Any]) -> DataArray:
        """Return the values of ``function`` for all steps of all runs; NaN for missing runs."""


class Output(Component):
    """Files that show a run or a study.

    `write` is called when all load steps are solved; after an interruption it gets the finished
    steps. The file names of an output begin with its stem, which the framework makes unique:
    ``NAME-type``, or ``NAME-name`` if the output has a field ``name`` that is not empty.
    """

    family: ClassVar[str] = "output"
    place: ClassVar[str] = "outputs[]"
    scope: ClassVar[Literal["run", "study", "both"]] = "both"
    """Whether the output can show a run, a study or both.

    In a study, an output of scope ``"run"`` shows each run separately; any other shows the study as
    a whole. In a single run an output of scope ``"study"`` is skipped.
    """
    of_contact: ClassVar[bool] = False
    """Whether it shows a contact, which a run with a load does not have."""
    shares_stem: ClassVar[bool] = False
    """Whether the stem is ``NAME`` alone; the class then has to define `suffixes`."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Ends of its file names, which follow the stem; ``*`` stands for any text."""
        return ("*",)

    @classmethod
    def check_class(cls) -> None:
        """Refuse a class that shows nothing."""
        if (cls.charts, cls.write) == (Output.charts, Output.write):
            raise PluginError(f"{cls.__name__} lacks the method charts, or write")

    def check(self, runs: Runs) -> None:
        """Refuse settings that do not fit a study, by a ConfigError; nothing is solved yet.

        The table of ``runs`` has the axes, and NaN for all numbers; of each run ``open`` returns
        the last step on four cells.
        """

    def charts(self, runs: Runs) -> Iterator[tuple[str, Shown]]:
        """Yield what the output shows, each with a suffix of its file names, often ""."""
        raise PluginError(f"{component_name(self)} has neither charts(runs) nor write(runs, stem)")

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write files whose paths begin with ``stem``, such as ``f"{stem}.txt"``; return the paths.

        Existing files of an earlier call are replaced. Of an output that has `charts` alone the
        framework writes the figures and tables, as PNG and CSV.
        """
        raise PluginError(
            f"{component_name(self)} has charts alone; pellicle.show.write_charts(output.charts("
            "runs), stem) writes them"
        )

    def step(self, record: Dataset, stem: Path) -> None:
        """Receive a load step, with dimension ``step`` of length 1, as soon as it is solved.

        Each step is passed once, in order, including those that an earlier process solved.
        """
