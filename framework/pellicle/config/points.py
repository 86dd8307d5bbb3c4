"""The runs of a study: one for each combination of values."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from pellicle.errors import ConfigError, Problem, first_of, shown
from pellicle.schema.model import Model
from pellicle.schema.paths import get, replaced
from pellicle.schema.ranges import Axes
from pellicle.units import split

from .run import Run


class Point(NamedTuple):
    """One run of a study."""

    position: tuple[int, ...]
    """Index along each dimension of the study."""
    run: Run


def points_of(table: Mapping[str, Any], dimensions: Mapping[str, Axes]) -> Iterator[Point]:
    """Yield the runs of a study, the last dimension varying fastest.

    ``table`` holds the fields that all runs share; ``dimensions`` is `Study.dimensions`.
    """
    problems: dict[Problem, list[str]] = {}
    names: dict[str, str] = {}
    shared = dict(table)
    shape = [len(next(iter(axes.values()))) for axes in dimensions.values()]
    for index in itertools.product(*map(range, shape)):
        values = {
            key: of_axis[number]
            for number, axes in zip(index, dimensions.values(), strict=True)
            for key, of_axis in axes.items()
        }
        name = ", ".join(f"{key} = {short(value)}" for key, value in values.items())
        try:
            run = _run(shared, values)
        except ConfigError as error:
            for problem in error.problems:
                problems.setdefault(_located(problem, table, values), []).append(name)
            continue
        if not names:
            # Fields that do not vary are created once: an indenter may hold a large surface.
            varied = {key.partition(".")[0] for key in values}
            shared |= {field: getattr(run, field) for field in run.model_fields_set - varied}
        if (identity := run.identity) in names:
            message = f"({names[identity]}) and ({name}) are the same run; leave one out"
            problems[Problem("vary", message)] = []
        names[identity] = name
        if not problems:
            yield Point(index, run)
    if problems:
        raise ConfigError(
            Problem(problem.field, f"{problem.message} (in the run of {first_of(runs)})")
            if problem.field[:4] == "run." and len(runs) < math.prod(shape)
            else problem
            for problem, runs in problems.items()
        )


def _run(shared: Mapping[str, Any], values: Mapping[str, Any]) -> Run:
    data: Any = shared
    for key, value in values.items():
        try:
            data = replaced(data, key, value)
        except ConfigError as error:
            raise error.within(key) from None
    return Run(**data)


def _located(problem: Problem, table: Mapping[str, Any], values: Mapping[str, Any]) -> Problem:
    """Return a problem under the name of the axis that caused it, or of the run if none did."""
    for key, value in values.items():
        is_new_table = key.startswith(f"{problem.field}.") and get(table, problem.field) is None
        if f"{problem.field}.".startswith(f"{key}.") or is_new_table:
            prefix = "" if shown(value) in problem.message else f"{shown(value)}: "
            return Problem(f"vary.{key}", f"{prefix}{problem.message}")
    return Problem(f"run.{problem.field}".removesuffix("."), problem.message)


def short(value: object) -> str:
    """Return a value as short text for the name of a run."""
    if isinstance(value, Model):
        value = {"type": getattr(value, "type_name", "?")}
    if isinstance(value, Mapping):
        return str(value.get("type", "{…}"))
    text = value if isinstance(value, str) else json.dumps(value, default=str)
    if (parts := split(text)) is not None:
        text = f"{parts[0]:.6g} {parts[1]}".rstrip()
    return text if len(text) <= 30 else f"{text[:29]}…"
