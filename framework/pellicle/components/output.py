"""The contract of outputs."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatchcase
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal

from pellicle.checks import component_name
from pellicle.errors import ConfigError, PluginError, shown
from pellicle.results.runs import Runs as Runs

from .base import Component

if TYPE_CHECKING:
    import xarray as xr


class Output(Component):
    """Files that show a run or a study.

    `write` is called once the load steps are solved, with those that are finished also after an
    interruption. The files of an output begin with its stem, which the framework makes unique:
    ``NAME-type``, or ``NAME-name`` where the output has a field ``name`` that is not empty.
    """

    family: ClassVar[str] = "output"
    replaced_methods: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("open", "close", "study", "endings", "resume"), "write(runs, stem)"
    )
    scope: ClassVar[Literal["run", "study", "both"]] = "both"
    """What it can show: a run, a study, or either.

    Of a study, an output of scope ``"run"`` shows each run on its own, any other the study as a
    whole. An output of scope ``"study"`` is skipped in a run that stands alone.
    """
    shares_stem: ClassVar[bool] = False
    """Whether its stem is ``NAME`` alone; then its `suffixes` have to be given."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """What follows its stem in the names of its files; ``*`` stands for anything."""
        return ("*",)

    @abstractmethod
    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write files whose paths begin with ``stem``, such as ``f"{stem}.txt"``; return them.

        Whatever is there of an earlier call is replaced.
        """

    def step(self, record: xr.Dataset, stem: Path) -> None:
        """Take a load step, a dataset with dimension ``step`` of length 1, as soon as it is solved.

        Each step comes once, in order; those that an earlier process solved come first.
        """


def stem_of(output: Output, stem: Path) -> Path:
    """Return the stem of an output in a run or study whose own stem is ``stem``."""
    return stem.with_name(f"{stem.name}{_own_suffix(output)}")


def refuse_shared_files(outputs: Sequence[Output], *, of_study: bool = False) -> None:
    """Refuse outputs that would write the same file, or one that the framework writes itself.

    Raises
    ------
    ConfigError
        Names the output, the file, what else writes it, and the field to change.
    PluginError
        The suffixes of an output are not a tuple of texts.
    """
    for index, output in enumerate(outputs):
        if of_study and output.scope != "run":
            name, owner, reserved = "study", "the table of the study", [".h5", ".csv"]
        else:
            name, owner, reserved = "NAME", "the result of the run", [".h5"]
        if shared := _shared(reserved, _suffixes(output)):
            raise ConfigError(
                f"{output.type_name!r} would write {name}{shared}, {owner}; leave it out",
                f"outputs.{index}.type",
            )
        for earlier, other in enumerate(outputs[:index]):
            if shared := _shared(_suffixes(output), _suffixes(other)):
                raise _refusal(shared, (index, output), (earlier, other))


def _refusal(shared: str, *both: tuple[int, Output]) -> ConfigError:
    """Return the error on two outputs of one file; one that can have another name should get it."""
    (index, output), (other_index, other) = sorted(
        both, key=lambda one: "name" not in type(one[1]).model_fields
    )
    is_nameable = "name" in type(output).model_fields
    return ConfigError(
        f"{output.type_name!r} would write NAME{shared}, as outputs.{other_index} "
        f"({other.type_name!r}) does; {'give it another name' if is_nameable else 'leave one out'}",
        f"outputs.{index}.{'name' if is_nameable else 'type'}",
    )


def _own_suffix(output: Output) -> str:
    return "" if output.shares_stem else f"-{getattr(output, 'name', '') or output.type_name}"


def _suffixes(output: Output) -> list[str]:
    """Return what follows the stem of the run in the names of an output's files."""
    suffixes: object = output.suffixes
    if not isinstance(suffixes, tuple) or not all(isinstance(text, str) for text in suffixes):
        raise PluginError(
            f"{component_name(output)}: suffixes is {shown(suffixes)}; it has to be a tuple of "
            'texts, such as (".txt",)'
        )
    return [f"{_own_suffix(output)}{suffix}" for suffix in suffixes]


def _shared(some: Iterable[str], others: Sequence[str]) -> str:
    """Return a suffix that is among both, or an empty text.

    Case does not count: some file systems do not distinguish it.
    """
    for one, other in product(some, others):
        if fnmatchcase(one.casefold(), other.casefold()):
            return one
        if fnmatchcase(other.casefold(), one.casefold()):
            return other
    return ""
