"""The contract of outputs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from fnmatch import fnmatchcase
from itertools import product
from pathlib import Path
from typing import Any, ClassVar, Literal, Protocol

from pellicle.arrays import DataArray, Dataset
from pellicle.checks import component_name, errors_attributed_to
from pellicle.errors import ConfigError, PluginError, shown
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

        Existing files of an earlier call are replaced. By default the figures and tables of
        `charts` are written, as PNG and CSV.
        """
        from pellicle.show import write_charts

        return write_charts(self.charts(runs), stem)

    def step(self, record: Dataset, stem: Path) -> None:
        """Receive a load step, with dimension ``step`` of length 1, as soon as it is solved.

        Each step is passed once, in order, including those that an earlier process solved.
        """


def stem_of(output: Output, stem: Path) -> Path:
    """Return the stem of an output in a run or study with the given stem."""
    return stem.with_name(f"{stem.name}{_own_suffix(output)}")


def refuse_shared_files(outputs: Sequence[Output], *, of_study: bool = False) -> None:
    """Refuse outputs that would write the same file, or one that the framework writes itself."""
    for index, output in enumerate(outputs):
        whole = of_study and output.scope != "run"
        others = {"the table of the study": [".h5", ".csv"]} if whole else {"the result": [".h5"]}
        for number, earlier in enumerate(outputs[:index]):
            others[f"outputs.{number} ({earlier.type_name!r})"] = _suffixes(earlier)
        for owner, suffixes in others.items():
            if shared := _shared(suffixes, _suffixes(output)):
                raise ConfigError(
                    f"{output.type_name!r} would write NAME{shared}, a file of {owner}; give it "
                    "another name if it can have one, or leave it out",
                    f"outputs.{index}.type",
                )


def _own_suffix(output: Output) -> str:
    return "" if output.shares_stem else f"-{getattr(output, 'name', '') or output.type_name}"


def _suffixes(output: Output) -> list[str]:
    """Return the ends of an output's file names, which follow the stem of the run."""
    suffixes: object = output.suffixes
    if not isinstance(suffixes, tuple) or not all(isinstance(text, str) for text in suffixes):
        raise PluginError(
            f"{component_name(output)}: suffixes is {shown(suffixes)}; it has to be a tuple of "
            'texts, such as (".txt",)'
        )
    return [f"{_own_suffix(output)}{suffix}" for suffix in suffixes]


def _shared(some: Iterable[str], others: Sequence[str]) -> str:
    """Return a suffix that both contain, whatever the case, as some file systems; else ""."""
    for one, other in product(some, others):
        if fnmatchcase(one.casefold(), other.casefold()):
            return one
        if fnmatchcase(other.casefold(), one.casefold()):
            return other
    return ""


def files_of(output: Output, runs: Runs, stem: Path) -> tuple[Path, ...]:
    """Let an output write its files for a run or study with the given stem; return their paths."""
    with errors_attributed_to(output):
        files = output.write(runs, stem_of(output, stem))
    require_files(output, files, stem)
    return tuple(files)


def require_files(output: Output, files: object, stem: Path) -> None:
    """Refuse the value that write() of an output returned unless it lists files of its own stem."""
    own = stem_of(output, stem)
    call = f"{component_name(output)}: write(runs, stem) returned"
    if not isinstance(files, (tuple, list)) or not all(isinstance(path, Path) for path in files):
        raise PluginError(
            f"{call} {shown(files)}; it has to return a tuple of pathlib.Path, empty if there is "
            "none"
        )
    for path in files:
        if not str(path).startswith(str(own)):
            raise PluginError(f"{call} {path}; its files have to begin with the stem, {own}")
