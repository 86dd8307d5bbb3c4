"""The configuration of a study: a run, the parameters that vary, the executor, and all runs."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from pellicle.components import Executor, FromRegistry, Table
from pellicle.errors import ConfigError, Problem, all_problems, excerpt, first_of, problems_within
from pellicle.results.derived import constants
from pellicle.schema.expression import CONSTANTS, FUNCTIONS, evaluate, names_in
from pellicle.schema.from_file import FromFile, overridden, paths_relative_to, read_toml
from pellicle.schema.model import get, python_names, replace_at
from pellicle.schema.ranges import Axes, expand
from pellicle.variables import FIELDS, VARIABLES

from .coordinates import Coordinate, as_json, coordinate, short, tell_apart
from .describe import words_at
from .file_names import refuse_shared_files
from .run import Run

DEFAULT_EXECUTOR = "serial"
_MOST = 100_000
"""Largest number of runs, which are all created before the first is solved."""
_MOST_NAMES = 1000
"""Largest number of parameters that vary, and of derived columns."""


class Point(NamedTuple):
    """One run of a study."""

    position: tuple[int, ...]
    """Index along each dimension of the study."""
    run: Run


def from_toml(path: str | Path, overrides: Iterable[str] = ()) -> Run | Study:
    """Return the study that a TOML file describes, or the run if it has no table ``study``."""
    kind = Study if "study" in overridden(read_toml(Path(path)), overrides) else Run
    return kind.from_toml(path, overrides)


def _as_table(value: object) -> object:
    if isinstance(value, Run):
        return {name: getattr(value, name) for name in value.model_fields_set}
    return dict(value) if isinstance(value, Mapping) else value


def _expanded(entries: object) -> tuple[Axes, ...]:
    if not isinstance(entries, (list, tuple)):
        raise ConfigError(f"{excerpt(entries)} is not allowed; give [[study.zip]] tables")
    tables = []
    for index, table in enumerate(entries):
        with problems_within(str(index)):
            tables.append(expand(table))
            lengths = {key: len(values) for key, values in tables[-1].items()}
            if len(set(lengths.values())) != 1:
                reason = ", ".join(f"{key} has {n}" for key, n in lengths.items()) or "is empty"
                raise ConfigError(f"{reason}; give axes of equally many values")
    return tuple(tables)


class Study(FromFile):
    """A run whose parameters vary: one run for each combination of values.

    All runs are created, and so validated, with the study.
    """

    run: Annotated[
        dict[str, Any], BeforeValidator(_as_table, json_schema_input_type=dict[str, Any])
    ] = Field(description="what all runs share: a run, or a mapping of the form of a run file")
    vary: Annotated[
        dict[str, tuple[Any, ...]], BeforeValidator(expand, json_schema_input_type=dict[str, Any])
    ] = Field(
        description="dotted parameter → values, each combined with each: a list, or {start, "
        'stop, num} with spacing = "log" if need be',
        default_factory=dict,
    )
    zip: Annotated[
        tuple[dict[str, tuple[Any, ...]], ...],
        BeforeValidator(_expanded, json_schema_input_type=list[dict[str, Any]]),
    ] = Field((), description="tables of parameters that take their values together, not combined")
    derived: dict[str, str] = Field(
        default_factory=dict,
        description="further numbers of the table: name → arithmetic expression",
    )
    executor: Annotated[Executor, FromRegistry()] | None = Field(
        None,
        description="what carries out the runs; without it this process, and processes once "
        "the runs left would take more than 10 s",
    )

    def _repr_html_(self) -> str:
        """Return HTML for a notebook: the varied parameters and the number of runs."""
        from pellicle.show.notebook import summary

        run = self.points[0].run
        configuration = run.to_table()
        rows = [
            (words_at(configuration, Run, name), ", ".join(map(str, values)), name)
            for axes in self.dimensions.values()
            for name, values in axes.items()
        ]
        table = Table.of_rows(("varied", "values", "field"), rows)
        return summary(run.title or "Study", f"{len(self.points)} runs", table)

    @model_validator(mode="after")
    def _create_runs(self) -> Self:
        self._check_axes()
        self._check_derived()
        with problems_within("run"):
            refuse_shared_files(self.points[0].run.outputs or (), of_study=True)
        return self

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """The runs, with the last dimension varying fastest."""
        # Workers may run in another current folder.
        with paths_relative_to(None):
            return tuple(_points_of(self.run, self.dimensions))

    @property
    def dimensions(self) -> dict[str, Axes]:
        """The axes along each dimension of the table, by the name of the dimension.

        Each varied parameter is a dimension; zipped parameters share one, named after the first.
        """
        return {key: {key: values} for key, values in self.vary.items()} | {
            next(iter(table)): table for table in self.zip
        }

    @property
    def _parameters(self) -> list[str]:
        return [*self.vary, *itertools.chain.from_iterable(self.zip)]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values along each dimension."""
        return tuple(len(next(iter(axes.values()))) for axes in self.dimensions.values())

    def coordinates(self) -> dict[str, tuple[str, Coordinate]]:
        """Return dimension and values, in SI, of each varied parameter."""
        coordinates = {
            key: (dimension, coordinate(key, values, self._runs_along(number)))
            for number, (dimension, axes) in enumerate(self.dimensions.items())
            for key, values in axes.items()
        }
        tell_apart({key: axis for key, (_, axis) in coordinates.items()})
        return coordinates

    def _runs_along(self, number: int) -> list[Run]:
        """Return a run for each value along a dimension, at the first value of all others."""
        stride = math.prod(self.shape[number + 1 :])
        return [point.run for point in self.points[: stride * self.shape[number] : stride]]

    @property
    def varying(self) -> set[str]:
        """The dotted paths of numbers of the first run in which others differ, beside the axes."""
        first = self.points[0].run
        others = [run for number in range(len(self.dimensions)) for run in self._runs_along(number)]
        return {
            path
            for path, value in constants(first).items()
            if any(get(run, path) != value for run in others)
        } - {*self._parameters}

    @classmethod
    def from_mapping(cls, data: Mapping[str, Any]) -> Self:
        """Return the study that a mapping of the form of a study file describes."""
        study = data.get("study")
        if not isinstance(study, Mapping):
            raise ConfigError(
                'is missing, so this is a single run; vary something: [study.vary] "kernel.tension"'
                " = […]",
                "study",
            )
        run = {key: value for key, value in data.items() if key != "study"}
        try:
            return cls(**{"run": run, **study})
        except ConfigError as error:
            raise ConfigError(
                Problem(field.removeprefix("run."), message)
                if field.startswith("run.")
                else Problem(f"study.{field}", message)
                for field, message in error.problems
            ) from None

    def to_json(self, *, portable: bool = False) -> str:
        """Return the study as JSON; see `to_table`."""
        return json.dumps(self.to_table(portable=portable), ensure_ascii=False)

    def to_table(self, *, portable: bool = False) -> dict[str, Any]:
        """Return the table of a study file, with ranges written out as lists.

        Values are kept as the user gave them; paths of input files are absolute unless
        ``portable``.
        """
        tables = [
            {
                key: [
                    as_json(value, get(run, key), portable=portable)
                    for value, run in zip(values, self._runs_along(number), strict=True)
                ]
                for key, values in axes.items()
            }
            for number, axes in enumerate(self.dimensions.values())
        ]
        count = len(self.vary)
        study = {
            "executor": self.executor and self.executor.model_dump(mode="json", exclude_none=True),
            "vary": {key: values for table in tables[:count] for key, values in table.items()},
            "zip": tables[count:],
            "derived": self.derived,
        }
        first = self.points[0].run
        run = {
            key: as_json(value, get(first, key), portable=portable)
            for key, value in self.run.items()
        }
        axes_and_options = {name: value for name, value in study.items() if value}
        return {**run, "study": axes_and_options}

    def _check_axes(self) -> None:
        if not self._parameters:
            raise ConfigError("varies nothing; give at least one axis", "vary")
        for name, of in (("vary", self._parameters), ("derived", self.derived)):
            if len(of) > _MOST_NAMES:
                raise ConfigError(f"has {len(of)} entries; give {_MOST_NAMES} at most", name)
        for parameter in self._parameters:
            with problems_within("vary"):
                # Raises for one that is too long, which the message of a run would begin with.
                replace_at({}, parameter, None)
        for first, second in itertools.combinations(self._parameters, 2):
            if first == second or first.startswith(f"{second}.") or second.startswith(f"{first}."):
                short, long = sorted((first, second), key=len)
                raise ConfigError(
                    f"would override the axis {short}, which sets the same value; leave one out",
                    f"vary.{long}",
                )
        if (count := math.prod(self.shape)) > _MOST:
            # Python does not write whole numbers of more than 4300 digits.
            text = count if count < 10**18 else "more than 10¹⁸"
            raise ConfigError(f"gives {text} runs; give values for {_MOST} at most", "vary")

    def _check_derived(self) -> None:
        """Refuse expressions with names that the table will not have, before any run is solved."""
        run = self.points[0].run
        texts = {name for name, variable in VARIABLES.items() if variable.type == "text"}
        allowed = {*FIELDS, *constants(run)} | {
            variable.name
            for point in self.points
            for variable in point.run.variables
            if point.run is run or variable.kind in ("interaction", "path", "oscillation")
        }
        allowed |= {*self._parameters}
        names = python_names(self._parameters).values()
        columns = {*texts, *names, "run", "step", "x", "y"}
        reserved = {*FUNCTIONS, *CONSTANTS, *columns}
        varying = self.varying if self.derived else set()
        with all_problems() as within:
            for name, text in self.derived.items():
                with within(f"derived.{name}"):
                    if differ := sorted(names_in(text) & varying):
                        raise ConfigError(
                            f"{excerpt(differ[0])} in {excerpt(text)} is not one number: runs "
                            f"differ in it; name an axis, or make {differ[0]} one"
                        )
                    if name in allowed | reserved:
                        raise ConfigError(
                            f"{excerpt(name)} has a meaning already; give another name"
                        )
                    if not name.isidentifier():
                        raise ConfigError(
                            f"{excerpt(name)} is not a name; give one of letters, digits and _"
                        )
                    evaluate(text, dict.fromkeys(allowed - {*FIELDS}, np.float64(1.0)))
                allowed.add(name)


def _points_of(table: Mapping[str, Any], dimensions: Mapping[str, Axes]) -> Iterator[Point]:
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
            data: Any = shared
            for key, value in values.items():
                with problems_within(key):
                    data = replace_at(data, key, value)
            run = Run(**data)
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


def _located(problem: Problem, table: Mapping[str, Any], values: Mapping[str, Any]) -> Problem:
    """Return a problem under the name of the axis that caused it, or of the run if none did."""
    for key, value in values.items():
        is_new_table = key.startswith(f"{problem.field}.") and get(table, problem.field) is None
        if f"{problem.field}.".startswith(f"{key}.") or is_new_table:
            prefix = "" if excerpt(value) in problem.message else f"{excerpt(value)}: "
            return Problem(f"vary.{key}", f"{prefix}{problem.message}")
    return Problem(f"run.{problem.field}".removesuffix("."), problem.message)
