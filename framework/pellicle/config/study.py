"""The configuration of a study: a run, the parameters that vary, and how it is carried out."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from pellicle import memory
from pellicle.components import Executor
from pellicle.errors import ConfigError, Problem, shown
from pellicle.model import ranges as axes
from pellicle.model.base import Model
from pellicle.model.expression import CONSTANTS, FUNCTIONS, evaluate
from pellicle.model.from_file import FromFile, read
from pellicle.model.input_path import AS_GIVEN, paths_relative_to
from pellicle.model.input_path import as_given as path_as_given
from pellicle.model.paths import replaced
from pellicle.plugins import registry
from pellicle.results.derived import constants
from pellicle.results.variables import FIELDS, VARIABLES, corrected_area, names_of
from pellicle.units import quantity_of, split

from .component_field import FromRegistry
from .json_schema import json_schema
from .loading import Loading, loading_model
from .output_conflicts import refuse_clashes_with_study
from .run import Run

DEFAULT_EXECUTOR = "serial"
_BYTES_PER_RUN = 40_000
_IN_PART = "InPart"

Axes = Mapping[str, axes.Values]


class Point(NamedTuple):
    """One run of a study."""

    place: tuple[int, ...]
    """Where it is along each dimension of the study."""
    name: str
    """What is varied, with its values."""
    run: Run


class Coordinate(NamedTuple):
    """The values that a parameter takes along a dimension."""

    values: np.ndarray[tuple[int], np.dtype[Any]]
    """SI numbers, or texts."""
    attributes: dict[str, str]
    """Unit and meaning."""


def from_toml(path: str | Path, overrides: Iterable[str] = ()) -> Run | Study:
    """Return the study that a TOML file describes, or the run where it has no table ``study``.

    Raises
    ------
    ConfigError, PluginError
        As for both of them.
    """
    kind = Study if "study" in read(path, overrides) else Run
    return kind.from_toml(path, overrides)


def schema() -> dict[str, Any]:
    """Return the JSON schema of a run or study file, with every component that is installed.

    In a study what varies may be left out, so that nothing but the type of a component is required.
    """
    run, study = json_schema(Run), json_schema(Study)
    definitions = run.pop("$defs") | study.pop("$defs")
    study["properties"].pop("run")
    study["required"] = []
    file = _in_part(run)
    file["properties"]["study"] = study
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **file,
        "if": {"required": ["study"]},
        "else": run,
        "$defs": definitions
        | {f"{name}{_IN_PART}": _in_part(each) for name, each in definitions.items()},
    }


def _in_part(schema: Any) -> Any:
    """Return a schema that also accepts what lacks fields."""
    if isinstance(schema, list):
        return [_in_part(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    made = {name: _in_part(each) for name, each in schema.items() if not _of_presence(each)}
    if isinstance(required := schema.get("required"), list):
        made["required"] = [name for name in required if name == "type"]
    if isinstance(ref := schema.get("$ref"), str):
        made["$ref"] = f"{ref}{_IN_PART}"
    return made


def _of_presence(choices: Any) -> bool:
    """Whether these are the choices of fields of which one must be there, as of moduli."""
    return (
        isinstance(choices, list)
        and bool(choices)
        and all(isinstance(each, dict) and each.keys() == {"required"} for each in choices)
    )


def _as_table(given: object) -> object:
    if isinstance(given, Run):
        return {name: getattr(given, name) for name in given.model_fields_set}
    return dict(given) if isinstance(given, Mapping) else given


def _each_expanded(given: object) -> tuple[Axes, ...]:
    if not isinstance(given, (list, tuple)):
        raise ConfigError(f"{shown(given)} is not allowed; give [[study.zip]] tables")
    tables = []
    for index, table in enumerate(given):
        try:
            tables.append(axes.expand(table))
            _same_length(tables[-1])
        except ConfigError as error:
            raise error.within(str(index)) from None
    return tuple(tables)


def _same_length(table: Axes) -> None:
    lengths = {key: len(values) for key, values in table.items()}
    if not table or len(set(lengths.values())) > 1:
        said = ", ".join(f"{key} has {length}" for key, length in lengths.items()) or "is empty"
        raise ConfigError(f"{said}; give axes of as many values as each other")


class Study(FromFile):
    """A run whose parameters vary: one run for each combination of values.

    The runs are made, and so checked, at once; `points` has them.
    """

    run: Annotated[
        dict[str, Any],
        BeforeValidator(_as_table, json_schema_input_type=dict[str, Any]),
        Field(description="what all runs share: a run, or a mapping of the form of a run file"),
    ]
    vary: Annotated[
        dict[str, tuple[Any, ...]],
        BeforeValidator(axes.expand, json_schema_input_type=dict[str, Any]),
        Field(
            description="dotted parameter → values, each combined with each: a list, or {start, "
            'stop, num} with spacing = "log" if need be',
            default_factory=dict,
        ),
    ]
    zip: Annotated[
        tuple[dict[str, tuple[Any, ...]], ...],
        BeforeValidator(_each_expanded, json_schema_input_type=list[dict[str, Any]]),
        Field(description="tables of parameters that take their values together, not combined"),
    ] = ()
    derived: Annotated[
        dict[str, str],
        Field(
            description="further numbers of the table: name → arithmetic expression",
            default_factory=dict,
        ),
    ]
    executor: Annotated[
        Executor,
        FromRegistry(),
        Field(
            description="what carries out the runs",
            default_factory=lambda: registry().make(Executor, {"type": DEFAULT_EXECUTOR}),
        ),
    ]
    _points: tuple[Point, ...] = PrivateAttr()

    @model_validator(mode="after")
    def _expand(self) -> Self:
        self._check_axes()
        # Workers may have another current folder.
        with paths_relative_to(None):
            self._points = tuple(self._make_points())
        self._check_derived()
        try:
            refuse_clashes_with_study(self.points[0].run.outputs or ())
        except ConfigError as error:
            raise error.within("run") from None
        return self

    @property
    def points(self) -> tuple[Point, ...]:
        """The runs, those that differ in the last dimension next to each other."""
        return self._points

    @property
    def dimensions(self) -> dict[str, Axes]:
        """The axes along each dimension of the table, by the dimension's name.

        Each varied parameter is a dimension; parameters that are zipped share one, which has the
        name of the first of them.
        """
        return {key: {key: values} for key, values in self.vary.items()} | {
            next(iter(table)): table for table in self.zip
        }

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values along each dimension."""
        return tuple(len(next(iter(axes.values()))) for axes in self.dimensions.values())

    def coordinates(self) -> dict[str, tuple[str, Coordinate]]:
        """Return the dimension and the values of each varied parameter, SI."""
        made = {}
        for number, (dimension, along) in enumerate(self.dimensions.items()):
            runs = [point.run for point in self.points if not any(_without(point.place, number))]
            for key, values in along.items():
                made[key] = dimension, _coordinate(runs, key, values)
        return made

    @classmethod
    def from_mapping(cls, data: Mapping[str, Any]) -> Self:
        """Return the study that a mapping of the form of a study file describes.

        Raises
        ------
        ConfigError, PluginError
            As for `from_toml`.
        """
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

    def to_json(self, *, as_given: bool = False) -> str:
        """Return the study as JSON of the form of a study file; ranges are lists.

        Values are as they were given; paths of files to read are absolute, or as they were given.
        """
        run = self.points[0].run
        vary, *zipped = (
            {
                key: [
                    _said(value, _reach(of, key), as_given)
                    for value, of in self._along(key, values)
                ]
                for key, values in table.items()
            }
            for table in (self.vary, *self.zip)
        )
        study = {"vary": vary, "zip": zipped, "derived": self.derived}
        kept = {name: value for name, value in study.items() if value}
        executor = self.executor.model_dump(mode="json", exclude_none=True)
        said = {
            key: _said(value, getattr(run, key, None), as_given) for key, value in self.run.items()
        }
        return json.dumps({**said, "study": {"executor": executor, **kept}}, ensure_ascii=False)

    def _along(self, key: str, values: axes.Values) -> Iterator[tuple[Any, Run]]:
        """Yield each value of an axis with a run that has it."""
        number = next(n for n, along in enumerate(self.dimensions.values()) if key in along)
        for point in self.points:
            if not any(_without(point.place, number)):
                yield values[point.place[number]], point.run

    def _check_axes(self) -> None:
        keys = [*self.vary, *itertools.chain.from_iterable(self.zip)]
        if not keys:
            raise ConfigError("varies nothing; give at least one axis", "vary")
        for one, other in itertools.combinations(keys, 2):
            if one == other or one.startswith(f"{other}.") or other.startswith(f"{one}."):
                short, long = sorted((one, other), key=len)
                raise ConfigError(
                    f"would override the axis {short}, which sets the same; leave one out",
                    f"vary.{long}",
                )
        needed, there = _BYTES_PER_RUN * math.prod(self.shape), memory.available()
        if there is not None and needed > there:
            raise ConfigError(
                f"{math.prod(self.shape)} runs need about {needed / 1e9:.3g} GB for the list of "
                f"them alone, and {there / 1e9:.3g} GB are available; give fewer values",
                "vary",
            )

    def _check_derived(self) -> None:
        """Refuse expressions that name what a table will not have, before anything is run."""
        run = self.points[0].run
        absent = {"status", "status_code", *names_of("requested")} - run.loading.variables
        there = {*VARIABLES, *constants(json.loads(run.to_json()))} - absent
        there |= run.loading.variables
        there |= {corrected_area(c.type_name).name for c in run.corrections}
        there |= {*self.vary, *itertools.chain.from_iterable(self.zip)}
        taken = {*FUNCTIONS, *CONSTANTS, "status", "status_code", "run", "step", "x", "y"}
        problems: list[Problem] = []
        for name, text in self.derived.items():
            try:
                if name in there | taken:
                    raise ConfigError(f"{shown(name)} has a meaning already; give another name")
                if not name.isidentifier():
                    raise ConfigError(
                        f"{shown(name)} is no name; give one of letters, digits and _"
                    )
                evaluate(text, dict.fromkeys(there - {*FIELDS}, np.float64(1.0)))
            except ConfigError as error:
                problems.extend(error.within(f"derived.{name}").problems)
            there.add(name)
        if problems:
            raise ConfigError(problems)

    def _make_points(self) -> Iterator[Point]:
        """Yield the runs; raise all that is wrong with them, each problem once."""
        problems: dict[Problem, list[str]] = {}
        owners: dict[str, str] = {}
        shared = dict(self.run)
        for index in itertools.product(*map(range, self.shape)):
            values = self._values_at(index)
            name = ", ".join(f"{key} = {_short(value)}" for key, value in values.items())
            try:
                run = _make_run(shared, values)
            except ConfigError as error:
                for problem in error.problems:
                    problems.setdefault(self._located(problem, values), []).append(name)
                continue
            if not owners:
                # What no axis touches is made once: it may hold a whole surface.
                touched = {key.partition(".")[0] for key in values}
                shared |= {n: getattr(run, n) for n in run.model_fields_set - touched}
            if (identity := run.identity) in owners:
                message = f"({owners[identity]}) and ({name}) are the same run; leave one out"
                problems[Problem("vary", message)] = []
            owners[identity] = name
            if not problems:
                yield Point(index, name, run)
        if problems:
            total = math.prod(self.shape)
            raise ConfigError(
                Problem(field, _among(message, names, total) if field[:4] == "run." else message)
                for (field, message), names in problems.items()
            )

    def _values_at(self, index: tuple[int, ...]) -> dict[str, Any]:
        return {
            key: values[at]
            for at, along in zip(index, self.dimensions.values(), strict=True)
            for key, values in along.items()
        }

    def _located(self, problem: Problem, values: Mapping[str, Any]) -> Problem:
        """Return a problem of a run under the name of the axis that caused it, if one did."""
        for key, value in values.items():
            invented = (
                key.startswith(f"{problem.field}.") and _reach(self.run, problem.field) is None
            )
            if f"{problem.field}.".startswith(f"{key}.") or invented:
                said = "" if shown(value) in problem.message else f"{shown(value)}: "
                return Problem(f"vary.{key}", f"{said}{problem.message}")
        return Problem(f"run.{problem.field}".removesuffix("."), problem.message)


def _make_run(shared: Mapping[str, Any], values: Mapping[str, Any]) -> Run:
    data: Any = shared
    for key, value in values.items():
        try:
            data = replaced(data, key, value)
        except ConfigError as error:
            raise error.within(key) from None
    return Run(**data)


def _among(message: str, names: list[str], total: int) -> str:
    if len(names) == total:
        return message
    others = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return f"{message} (in the run of {names[0]}{others})"


def _without(index: tuple[int, ...], number: int) -> tuple[int, ...]:
    return index[:number] + index[number + 1 :]


def _short(value: object) -> str:
    """Return a value as names of runs have it."""
    if isinstance(value, Model):
        value = {"type": getattr(value, "type", "?")}
    if isinstance(value, Mapping):
        return str(value.get("type", "{…}"))
    text = value if isinstance(value, str) else json.dumps(value, default=str)
    if (found := split(text)) is not None:
        text = f"{found[0]:.6g} {found[1]}".rstrip()
    return text if len(text) <= 30 else f"{text[:29]}…"


def _reach(at: Any, key: str) -> Any:
    """Return what a dotted key leads to in a run, or in a table like one; None if to nothing."""
    for name in key.split("."):
        if isinstance(at, Mapping):
            at = at.get(name)
        elif isinstance(at, (list, tuple)):
            at = at[int(name)] if name.isdecimal() and int(name) < len(at) else None
        else:
            at = getattr(at, name, None)
    return at


def _said(value: Any, made: Any, as_given: bool = False) -> Any:
    """Return a value as JSON has it, paths absolute or as given; ``made`` is what became of it."""
    if isinstance(value, Model):
        context = AS_GIVEN if as_given else None
        return value.model_dump(mode="json", exclude_none=True, context=context)
    if isinstance(made, Path):
        return path_as_given(made) if as_given else str(made)
    if isinstance(value, Mapping):
        return {name: _said(inner, _reach(made, name), as_given) for name, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [
            _said(inner, _reach(made, str(index)), as_given) for index, inner in enumerate(value)
        ]
    if hasattr(value, "tolist"):
        return value.tolist()
    return value if isinstance(value, (str, int, float, bool)) else str(value)


def _coordinate(runs: list[Run], key: str, given: axes.Values) -> Coordinate:
    """Return the values of an axis as the runs have them: SI numbers, or texts."""
    held = [_one(_reach(run, key), value) for run, value in zip(runs, given, strict=True)]
    attributes = {"long_name": key}
    if all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in held):
        if unit := _unit_of(runs[0], key):
            attributes["units"] = unit
        return Coordinate(np.array(held), attributes)
    texts = [value if isinstance(value, str) else _short(given[i]) for i, value in enumerate(held)]
    if len(set(texts)) < len(texts):
        texts = [json.dumps(_said(value, held[i])) for i, value in enumerate(given)]
    return Coordinate(np.array(texts, dtype=object), attributes)


def _one(held: Any, given: Any) -> Any:
    """Return a value that was given as one and is held as several equal ones: a size, a depth."""
    several = isinstance(held, tuple) and held and len(set(map(str, held))) == 1
    if several and not isinstance(given, (list, tuple, Mapping)):
        return held[0]
    return path_as_given(held) if isinstance(held, Path) else held


def _unit_of(run: Run, key: str) -> str | None:
    """Return the SI unit of the field that a dotted key leads to."""
    *path, last = key.split(".")
    while last.isdecimal() and path:
        last = path.pop()
    owner = _reach(run, ".".join(path)) if path else run
    model = loading_model(owner.prescribed) if isinstance(owner, Loading) else type(owner)
    info = model.model_fields.get(last) if issubclass(model, Model) else None
    quantity = quantity_of(info) if info else None
    # As datasets write areas, not as units are multiplied.
    return quantity.unit.replace("m**2", "m2") if quantity else None
