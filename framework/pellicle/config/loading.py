"""The load steps of a run: what is prescribed, and with which options."""

from __future__ import annotations

import inspect
import itertools
import math
from collections.abc import Mapping, Sequence
from functools import cache, cached_property
from itertools import filterfalse
from typing import Annotated, Any, ClassVar, Self, cast

from pydantic import (
    Field,
    GetJsonSchemaHandler,
    SerializationInfo,
    SkipValidation,
    WithJsonSchema,
    create_model,
    model_serializer,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from pellicle.components import FromRegistry, Prescription
from pellicle.components.installed import registry
from pellicle.components.prescription import OPTIONS
from pellicle.errors import ConfigError, Problem, all_problems, excerpt
from pellicle.schema.messages import no_field
from pellicle.schema.model import Model
from pellicle.units import Quantity

from .legs import Leg, LoadSteps, Sample, samples_of_legs

_TIME = (
    "time [s] at the end of each step, for a solid that relaxes; equal times are a jump, and the "
    "first step is one"
)
# Messages name these first.
_USUAL = "depth", "force", "mean_pressure"


class Options(Model):
    """The keys of ``[loading]`` beside what is prescribed."""

    stiffness: bool = Field(
        False,
        description="whether to compute the contact stiffness dF/dδ of each step, by one more "
        "linear solve per step",
    )

    time: Annotated[tuple[float, ...], LoadSteps(Quantity("s"))] | None = Field(
        None, description=_TIME
    )


class Times(Model):
    """The keys of ``[loading]`` beside a load, whose own fields are what varies."""

    samples: ClassVar[tuple[Sample, ...]] = ()
    stiffness: ClassVar[bool] = False
    oscillates: ClassVar[bool] = False
    time: Annotated[tuple[float, ...], LoadSteps(Quantity("s"))] | None = Field(
        None, description=_TIME
    )

    @property
    def times(self) -> tuple[float, ...] | None:
        """Time [s] at the end of each load step; None without times."""
        return self.time

    @cached_property
    def durations(self) -> tuple[float, ...]:
        """Duration [s] of each load step; 0 for a jump, as the first one is."""
        times = self.time or ()
        return durations_of((*times[:1], *times))


class Loading(Options):
    """The load steps: exactly one quantity is prescribed, in the order of its path.

    The key is the type of a prescription; its value is one value, a list, or a ramp
    ``{start, stop, num}``, optionally with ``spacing = "log"``; with ``back = true`` the ramp
    returns to its start through the same values. A list of legs ``{to, time, num}``, ``{hold,
    num}`` and ``{amplitude, frequency, cycles, num}`` gives values and times. The fields of the
    prescription are further keys.
    """

    prescription: Annotated[Prescription, FromRegistry()] = Field(
        description="the prescription with its fields"
    )

    # Only the prescription knows the unit and the range of the values: `fields_from` reads them.
    path: Annotated[SkipValidation[tuple[float, ...] | tuple[Leg, ...]], WithJsonSchema({})] = (
        Field(description="the prescribed values, or the legs through them")
    )

    def __init__(self, /, **table: Any) -> None:
        is_read = isinstance(table.get("prescription"), Prescription)
        super().__init__(**table if is_read else fields_from(table))

    @model_serializer
    def _table(self, info: SerializationInfo) -> dict[str, Any]:
        own = self.prescription.model_dump(mode=info.mode, exclude_none=True, context=info.context)
        table = {"stiffness": self.stiffness, "time": self.time, own.pop("type"): self.path, **own}
        return {name: value for name, value in table.items() if value is not None}

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Return the choice of one table for each prescription."""
        reference = handler(schema)
        whole = handler.resolve_ref_schema(reference)
        whole.clear()
        choices = []
        for type_, component in prescriptions().items():
            keys: dict[str, Any] = {n: (i.annotation, i) for n, i in keys_of(component).items()}
            table = create_model(f"Loading_{type_}", __base__=Model, **keys)
            choices.append(handler.resolve_ref_schema(handler(table.__pydantic_core_schema__)))
        whole.update(description=inspect.getdoc(cls), oneOf=choices)
        return reference

    @property
    def entries(self) -> Mapping[str, tuple[Any, FieldInfo]]:
        """Value and description of each key of its table in a file."""
        values = {**dict(self), **dict(self.prescription), self.prescribed: self.path}
        keys = keys_of(type(self.prescription))
        return {name: (values[name], info) for name, info in keys.items()}

    @model_validator(mode="after")
    def _check_time(self) -> Self:
        if self.time is None:
            return self
        if self.samples:
            raise ConfigError(
                f"is given beside the legs of {self.prescribed}, which have their own times; leave "
                "it out",
                "time",
            )
        check_times(self.time, len(self.values))
        return self

    @cached_property
    def prescribed(self) -> str:
        """The type of the prescription."""
        return self.prescription.type_name

    @cached_property
    def samples(self) -> tuple[Sample, ...]:
        """The load steps of a path in legs; none of any other path."""
        return (
            samples_of_legs(legs)
            if (legs := [leg for leg in self.path if isinstance(leg, Leg)])
            else ()
        )

    @cached_property
    def values(self) -> tuple[float, ...]:
        """The load steps in order, SI."""
        if self.samples:
            return tuple(sample.value for sample in self.samples)
        return cast("tuple[float, ...]", self.path)

    @cached_property
    def times(self) -> tuple[float, ...] | None:
        """Time [s] at the end of each load step, given or that of the legs; None without times."""
        return tuple(sample.time for sample in self.samples) if self.samples else self.time

    @cached_property
    def durations(self) -> tuple[float, ...]:
        """Duration [s] of each load step; 0 for a jump.

        Legs begin at time 0. Before the first of other steps nothing is known, so it is a jump.
        """
        times = self.times or ()
        start = (0.0,) if self.samples else times[:1]
        return durations_of((*start, *times))

    @cached_property
    def oscillates(self) -> bool:
        """Whether a leg is an oscillation."""
        return not all(math.isnan(sample.cycle) for sample in self.samples)

    def field_of(self, index: int) -> str:
        """Return the dotted path in a run of load step ``index``, from 0, or of its leg."""
        return f"loading.{self.prescribed}.{self.samples[index].leg if self.samples else index}"

    def refuse_pulls(self) -> None:
        """Refuse values that only an interaction allows, such as a force below 0."""
        with all_problems() as within, within(self.prescribed):
            LoadSteps(self.prescription.quantity(), legs=True)(self.path)


def durations_of(times: Sequence[float]) -> tuple[float, ...]:
    """Return the differences of times [s]."""
    return tuple(after - before for before, after in itertools.pairwise(times))


def check_times(times: Sequence[float], steps: int) -> None:
    """Refuse times [s] that fall, or are not one for each load step."""
    if len(times) != steps:
        raise ConfigError(
            f"has {len(times)} values for {steps} load steps; give one for each "
            "(there and back, 2 num − 1)",
            "time",
        )
    for index, (before, after) in enumerate(itertools.pairwise(times), start=1):
        if after < before:
            raise ConfigError(
                f"falls from {before:g} to {after:g} s; times must not fall", f"time.{index}"
            )


def times_from(table: object) -> Times:
    """Return the times beside a load from the table of a file, which prescribes nothing else."""
    if table is None or isinstance(table, Times):
        return table or Times()
    if not isinstance(table, Mapping):
        raise ConfigError(f"{excerpt(table)} is not allowed; give a table with time")
    with all_problems() as within:
        for name in table.keys() - Times.model_fields.keys():
            with within(name):
                raise ConfigError(
                    "needs an indenter, and this run has a load, whose own field is what varies "
                    "from step to step; of [loading] a load takes time alone"
                )
    return Times(**table)


def fields_from(table: Mapping[str, Any], interaction: bool = True) -> dict[str, Any]:
    """Return the fields of a `Loading` from the table of a file.

    Without an interaction values that pull, such as a force below 0, are refused.
    """
    data = {key: value for key, value in table.items() if value is not None}
    component = prescription_in(data)
    keys = keys_of(component)
    type_, *_ = keys
    own = {name: data[name] for name in keys.keys() & data.keys() - {type_, *OPTIONS}}
    with all_problems() as within:
        with within(type_):
            path = LoadSteps(component.quantity(interaction), legs=True)(data[type_])
        with within(""):
            prescription = registry().make(Prescription, {"type": type_, **own})
        with within(""):
            options = dict(Options(**{name: data[name] for name in OPTIONS if name in data}))
        for name in filterfalse(keys.__contains__, data):
            with within(name):
                raise ConfigError(no_field(name, keys))
    return {"prescription": prescription, "path": path, **options}


@cache
def keys_of(component: type[Prescription]) -> Mapping[str, FieldInfo]:
    """Return the keys of ``[loading]`` with a prescription: its type, its fields, the options."""
    meaning = (inspect.getdoc(component) or "").partition("\n")[0]
    steps = FieldInfo(annotation=tuple[float, ...], description=meaning)
    steps.metadata.append(LoadSteps(component.quantity(interaction=True), legs=True))
    fields = dict(component.model_fields)
    return {fields.pop("type").default: steps, **fields, **Options.model_fields}


def prescriptions() -> dict[str, type[Prescription]]:
    """Return the installed prescriptions by type."""
    entries = registry().components["prescription"]
    return {t: e.component for t, e in entries.items() if issubclass(e.component, Prescription)}


def prescription_in(data: Mapping[str, Any]) -> type[Prescription]:
    """Return the prescription that a key of a table names."""
    installed = prescriptions()
    keys = sorted(installed.keys() & data.keys())
    if len(keys) == 1:
        return installed[keys[0]]
    types = sorted(installed, key=lambda name: (name not in _USUAL, name))
    keys.sort(key=types.index)
    remedy = f"give exactly one of {', '.join(types)}"
    if keys:
        # One that an override adds stands last.
        last = [name for name in data if name in keys][-1]
        value = data[last] if isinstance(data[last], (str, float, int)) else "…"
        raise ConfigError(
            f"prescribes {' and '.join(keys)}; {remedy}; to set another one, replace the table: "
            f'--set loading="{{{last} = {value!r}}}"'
        )
    problems = []
    for key in filterfalse(OPTIONS.__contains__, data):
        try:
            registry().find("prescription", key)
        except ConfigError:
            problems.append(Problem(key, no_field(key, [*types, *OPTIONS])))
    raise ConfigError(problems or f"prescribes nothing; {remedy}")
