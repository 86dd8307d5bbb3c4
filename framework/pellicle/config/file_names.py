"""The files of outputs: their stems, and that no two outputs write the same file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase
from itertools import product
from pathlib import Path

from pellicle.checks import component_name
from pellicle.components import Output
from pellicle.errors import ConfigError, PluginError, excerpt


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
            f"{component_name(output)}: suffixes is {excerpt(suffixes)}; it has to be a tuple of "
            'texts, such as (".txt",)'
        )
    return [f"{_own_suffix(output)}{suffix}" for suffix in suffixes]


def _shared(some: Iterable[str], others: Sequence[str]) -> str:
    """Return a suffix that both contain, whatever the case, as some file systems; else ""."""
    for suffix, taken_suffix in product(some, others):
        if fnmatchcase(suffix.casefold(), taken_suffix.casefold()):
            return suffix
        if fnmatchcase(taken_suffix.casefold(), suffix.casefold()):
            return taken_suffix
    return ""
