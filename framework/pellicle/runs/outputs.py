"""Outputs get every step of a run and, at its end, write their files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TypeVar

import xarray as xr

from pellicle.checks import component_name, errors_attributed_to, read_only_dataset
from pellicle.components import Output, Runs
from pellicle.components.installed import registry
from pellicle.config.file_names import stem_of
from pellicle.config.run import Run
from pellicle.errors import ConfigError, PluginError, excerpt
from pellicle.show.saving import write_charts

from .journal import Journal

STANDARD_OUTPUTS = ("csv", "figures")
"""Types of the outputs of a configuration that names none."""
Value = TypeVar("Value")


def hand_over(
    step: xr.Dataset, outputs: Sequence[Output], journal: Journal, *, is_new: bool = False
) -> None:
    """Pass a step to every output; if it is new, first to the journal."""

    def give(output: Output) -> None:
        with errors_attributed_to(output):
            output.step(read_only_dataset(step), stem_of(output, journal.stem))

    calls = [partial(give, output) for output in outputs]
    call_all([partial(journal.append, step), *calls] if is_new else calls)


def writers(
    outputs: Sequence[Output], runs: Callable[[], Runs], stem: Path, run: Run
) -> list[Callable[[], tuple[Path, ...]]]:
    """Return for each output a function that writes its files.

    ``runs`` returns fresh data for each. A ConfigError names the output by its path in ``run``.
    """

    def write(output: Output) -> tuple[Path, ...]:
        try:
            return files_of(output, runs(), stem)
        except ConfigError as error:
            if not run.outputs:
                raise
            raise error.within(f"outputs.{run.outputs.index(output)}") from None

    return [partial(write, output) for output in outputs]


def call_all(calls: Iterable[Callable[[], Value]]) -> list[Value]:
    """Call all functions, even if one raises; return the values, or raise the first exception."""
    values: list[Value] = []
    errors: list[Exception] = []
    for call in calls:
        try:
            values.append(call())
        except Exception as error:
            errors.append(error)
    if errors:
        raise errors[0]
    return values


def standard_outputs(named: Sequence[Output] | None) -> Sequence[Output]:
    """Return the outputs that a configuration names, or the standard ones if it names none."""
    if named is not None:
        return named
    return [registry().make(Output, {"type": type_}) for type_ in STANDARD_OUTPUTS]


def files_of(output: Output, runs: Runs, stem: Path) -> tuple[Path, ...]:
    """Let an output write its files for a run or study with the given stem; return their paths."""
    own = stem_of(output, stem)
    with errors_attributed_to(output):
        if type(output).write is Output.write:
            files = write_charts(output.charts(runs), own)
        else:
            files = output.write(runs, own)
    call = f"{component_name(output)}: write(runs, stem) returned"
    if not isinstance(files, (tuple, list)) or not all(isinstance(path, Path) for path in files):
        raise PluginError(
            f"{call} {excerpt(files)}; it has to return a tuple of pathlib.Path, empty if there is "
            "none"
        )
    for path in files:
        if not str(path).startswith(str(own)):
            raise PluginError(f"{call} {path}; its files have to begin with the stem, {own}")
    return tuple(files)
