"""The load steps of a run: what is prescribed, and with which options."""

from __future__ import annotations

import inspect
import itertools
import math
from collections.abc import Mapping
from functools import cache, cached_property
from itertools import filterfalse
from typing import Annotated, Any, Self

from pydantic import ConfigDict, Field, create_model, model_validator
from pydantic.fields import FieldInfo

from pellicle.components import Prescription
from pellicle.errors import ConfigError, Problem
from pellicle.loading import OPTIONS, LoadSteps
from pellicle.plugins import registry
from pellicle.schema.legs import Leg, Sample, sampled
from pellicle.schema.messages import nearest
from pellicle.schema.model import Model
from pellicle.units import Quantity

# Messages name these first.
_USUAL = "depth", "force", "mean_pressure"


class Loading(Model):
    """The load steps: exactly one quantity is prescribed, in the order of its path.

    The key is the type of a prescription; its value is one value, a list, or a ramp
    ``{start, stop, num}``, optionally with ``spacing = "log"``; with ``back = true`` the ramp
    returns to its start through the same values. A list of legs ``{to, time, num}``, ``{hold,
    num}`` and ``{amplitude, frequency, cycles, num}`` gives values and times. The fields of the
    prescription are further keys.
    """

    model_config = ConfigDict(extra="allow")

    stiffness: Annotated[
        bool,
        Field(
            description="whether to compute the contact stiffness dF/dδ of each step, by one more "
            "linear solve per step"
        ),
    ] = False

    time: Annotated[
        tuple[float, ...] | None,
        LoadSteps(Quantity("s")),
        Field(
            description="time [s] at the end of each step, for a solid that relaxes; equal times "
            "are a jump, and the first step is one"
        ),
    ] = None

    @model_validator(mode="before")
    @classmethod
    def _read(cls, table: Any) -> Any:
        if not isinstance(table, Mapping):
            return table
        data = {key: value for key, value in table.items() if value is not None}
        model = loading_model(prescribed_in(data))
        return {key: value for key, value in model(**data) if value is not None}

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
        if len(self.time) != len(self.values):
            raise ConfigError(
                f"has {len(self.time)} values for {len(self.values)} load steps; give one for each "
                "(there and back, 2 num − 1)",
                "time",
            )
        for index, (before, after) in enumerate(itertools.pairwise(self.time), start=1):
            if after < before:
                raise ConfigError(
                    f"falls from {before:g} to {after:g} s; times must not fall",
                    f"time.{index}",
                )
        return self

    @cached_property
    def prescription(self) -> Prescription:
        """The prescription with its fields."""
        fields = self.__pydantic_extra__ or {}
        type_ = self.prescribed
        others = {name: value for name, value in fields.items() if name != type_}
        return registry().make(Prescription, {"type": type_, **others})

    @property
    def prescribed(self) -> str:
        """The type of the prescription."""
        return prescribed_in(self.__pydantic_extra__ or {})

    @property
    def described_fields(self) -> Mapping[str, FieldInfo]:
        """The options, the prescribed values and the fields of the prescription."""
        return loading_model(self.prescribed).model_fields

    @cached_property
    def samples(self) -> tuple[Sample, ...]:
        """The load steps of a path in legs; none of any other path."""
        path = getattr(self, self.prescribed)
        return sampled(path) if isinstance(path[0], Leg) else ()

    @cached_property
    def values(self) -> tuple[float, ...]:
        """The load steps in order, SI."""
        if self.samples:
            return tuple(sample.value for sample in self.samples)
        values: tuple[float, ...] = getattr(self, self.prescribed)
        return values

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
        return tuple(after - before for before, after in itertools.pairwise((*start, *times)))

    @cached_property
    def oscillates(self) -> bool:
        """Whether a leg is an oscillation."""
        return not all(math.isnan(sample.cycle) for sample in self.samples)

    def field_of(self, index: int) -> str:
        """Return the dotted path of load step ``index``, counted from 0, or of its leg."""
        return f"{self.prescribed}.{self.samples[index].leg if self.samples else index}"

    @property
    def variables(self) -> set[str]:
        """The names of the result variables that this loading adds."""
        timed = self.times is not None
        used = {"stiffness": self.stiffness, "time": timed, "cycle": self.oscillates}
        names = {variable.name for variable in self.prescription.variables}
        return names | {name for name, is_used in used.items() if is_used}


def refuse_pulls(loading: Mapping[str, Any]) -> None:
    """Refuse values of ``[loading]`` that only an interaction allows, such as a force below 0."""
    data = {key: value for key, value in loading.items() if value is not None}
    type_ = prescribed_in(data)
    try:
        loading_model(type_, interaction=False)(**data)
    except ConfigError as error:
        try:
            loading_model(type_)(**data)
        except ConfigError:
            raise error from None
        raise ConfigError(
            Problem(field, f"{reason}; with an [interaction] it may be negative")
            for field, reason in error.problems
        ) from None


@cache
def loading_model(type_: str, interaction: bool = True) -> type[Model]:
    """Return the model that validates ``[loading]`` with the prescription ``type_``.

    Without an interaction values that pull are refused.
    """
    component = registry().find("prescription", type_)
    assert issubclass(component, Prescription)
    options = {name: Loading.model_fields[name] for name in OPTIONS}
    fields = {n: info for n, info in component.model_fields.items() if n != "type"} | options
    meaning = (inspect.getdoc(component) or "").partition("\n")[0]
    steps: Any = Annotated[
        tuple[float, ...],
        LoadSteps(component.quantity(interaction), legs=True),
        Field(description=meaning),
    ]
    definitions: dict[str, Any] = {type_: (steps, ...)}
    definitions |= {name: (info.annotation, info) for name, info in fields.items()}
    return create_model(f"Loading_{type_}", __base__=Model, **definitions)


def prescribed_in(data: Mapping[str, Any]) -> str:
    """Return the key of a table that names its prescription."""
    families = registry().components["prescription"]
    types = [*_USUAL, *sorted(families.keys() - {*_USUAL})]
    keys = [name for name in types if name in data]
    if len(keys) == 1:
        return keys[0]
    if keys:
        reason = f"prescribes {' and '.join(keys)}"
    else:
        problems = []
        for key in filterfalse(OPTIONS.__contains__, data):
            try:
                registry().find("prescription", key)
            except ConfigError:
                message = f"is not a field here; {nearest(key, [*types, *OPTIONS])}"
                problems.append(Problem(key, message))
        if problems:
            raise ConfigError(problems)
        reason = "prescribes nothing"
    remedy = f"give exactly one of {', '.join(types)}"
    if keys:
        # One that an override adds stands last.
        last = [name for name in data if name in keys][-1]
        value = data[last] if isinstance(data[last], (str, float, int)) else "…"
        remedy += f'; to set another one, replace the table: --set loading="{{{last} = {value!r}}}"'
    raise ConfigError(f"{reason}; {remedy}")
