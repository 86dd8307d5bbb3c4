"""Outputs that would write the same files are refused before anything is computed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase

from pellicle.components import Output
from pellicle.components.calls import endings_of
from pellicle.errors import ConfigError

# What a study writes itself, and in each run.
_TABLE = ".h5", ".csv"
_RUN = (".h5",)


def refuse_clashes(outputs: Sequence[Output]) -> None:
    """Refuse outputs of one run that would write the same file.

    Raises
    ------
    ConfigError
        Names both outputs, the file, and the field to change.
    """
    for later, output in enumerate(outputs):
        for earlier, other in enumerate(outputs[:later]):
            if ending := _common(endings_of(output), endings_of(other)):
                raise _refusal(ending, (later, output), (earlier, other))


def refuse_clashes_with_study(outputs: Sequence[Output]) -> None:
    """Refuse outputs of a study that would write over the study's own files.

    Raises
    ------
    ConfigError
        Names the output and the file.
    """
    for index, output in enumerate(outputs):
        if output.type_name == "hdf5":
            continue
        taken, name, whose = (
            (_TABLE, "study", "the table of the study")
            if output.draws_studies
            else (_RUN, "NAME", "the result that each run of a study leaves")
        )
        if ending := _common(taken, endings_of(output)):
            raise ConfigError(
                f"{output.type_name!r} would write {name}{ending}, {whose}; leave it out",
                f"outputs.{index}.type",
            )


def matches(ending: str, told: str) -> bool:
    """Whether the ending of a file's name is what `Output.endings` told, with ``*`` for anything.

    Capital letters are as small ones: some file systems do not tell them apart.
    """
    return fnmatchcase(ending.casefold(), told.casefold())


def _common(some: Iterable[str], others: Sequence[str]) -> str:
    """Return an ending that is among both, empty if none is."""
    for one in some:
        for other in others:
            if matches(one, other):
                return one
            if matches(other, one):
                return other
    return ""


def _refusal(ending: str, *both: tuple[int, Output]) -> ConfigError:
    """Return what to say of two outputs: the first that can be given another name is to be."""
    (index, output), (other_index, other) = next(
        (pair for pair in (both, both[::-1]) if "name" in type(pair[0][1]).model_fields), both
    )
    named = "name" in type(output).model_fields
    return ConfigError(
        f"{output.type_name!r} would write NAME{ending}, as outputs.{other_index} "
        f"({other.type_name!r}) does; {'give it another name' if named else 'leave one out'}",
        f"outputs.{index}.{'name' if named else 'type'}",
    )
