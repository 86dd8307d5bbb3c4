"""The values of load steps: one value, a list, a ramp, or legs of a path in time."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, NamedTuple, assert_never, cast

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, create_model
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import core_schema

from pellicle.errors import ConfigError, all_problems, excerpt
from pellicle.schema.model import Model
from pellicle.schema.ranges import is_path, path_of, path_schemas, ramp
from pellicle.units import Quantity

_MOST = 1_000_000
# Three samples are the fewest that show an amplitude and a phase; four meet both extremes.
_FEWEST_OF_CYCLE = 4

Number = Annotated[
    int, Field(title="number of steps", ge=1, description="number of load steps of the leg")
]


class Sample(NamedTuple):
    """One load step of a path in legs."""

    value: float
    """The prescribed value, SI."""
    time: float
    """Time at the end of the step [s]."""
    leg: int
    """Index of its leg."""
    cycle: float = math.nan
    """Cycles since its leg began; NaN unless the leg oscillates."""


class Move(Model):
    """A ramp to a value: { to, time, num }."""

    to: float = Field(title="end value", description="value at the end of the leg")
    time: Annotated[float, Quantity("s", at_least=0)] = Field(
        title="duration", description="duration of the leg [s]; 0 is a jump"
    )
    num: Number


class Hold(Model):
    """A time at the value reached: { hold, num }."""

    hold: Annotated[float, Quantity("s", above=0)] = Field(
        title="duration", description="duration of the leg [s]"
    )
    num: Number


class Oscillation(Model):
    """A sine about the value reached: { amplitude, frequency, cycles, num }."""

    amplitude: float = Field(description="amplitude of the oscillation")
    frequency: Annotated[float, Quantity("Hz", above=0)] = Field(
        description="frequency of the oscillation [Hz]"
    )
    cycles: int = Field(title="number of cycles", ge=1, description="number of cycles")
    num: int = Field(
        title="steps of a cycle",
        ge=_FEWEST_OF_CYCLE,
        description="number of load steps of each cycle",
    )


Leg = Move | Hold | Oscillation
"""A part of a path that goes on from the end of the one before, in ``num`` load steps."""
KINDS: Mapping[str, type[Leg]] = {"to": Move, "hold": Hold, "amplitude": Oscillation}
"""The kinds of leg by the field that only this kind has."""
_FORMS = (
    "{ to, time, num }, { hold, num } or { amplitude, frequency, cycles, num }, with num steps "
    "for each leg, for each cycle of an oscillation"
)


@cache
def legs_with(quantity: Quantity) -> Mapping[str, type[Leg]]:
    """Return the kinds of leg whose prescribed values have unit and range of ``quantity``.

    They describe, and read tables; paths hold legs of the three kinds themselves, which pickle.
    """
    allowed = {"to": quantity, "amplitude": Quantity(quantity.unit, above=0)}
    kinds = dict(KINDS)
    for key in allowed:
        fields: Any = {key: (Annotated[float, allowed[key], KINDS[key].model_fields[key]], ...)}
        kinds[key] = create_model(KINDS[key].__name__, __base__=KINDS[key], **fields)
    return kinds


def legs_of(entries: Sequence[object], quantity: Quantity) -> tuple[Leg, ...]:
    """Return the legs of a path whose values have the unit and range of ``quantity``."""
    legs: list[Leg] = []
    with all_problems() as within:
        for index, entry in enumerate(entries):
            with within(str(index)):
                table = entry.model_dump() if isinstance(entry, Leg) else entry
                if not isinstance(table, Mapping):
                    raise ConfigError(
                        f"{excerpt(entry)} is not a leg, as others of the list are; give {_FORMS}"
                    )
                keys = [key for key in KINDS if key in table]
                if len(keys) != 1:
                    mixes = f"mixes {' and '.join(keys)}"
                    has = f"has {', '.join(map(str, table)) or 'no key'}"
                    raise ConfigError(f"{mixes if keys else has}; give {_FORMS}")
                legs.append(KINDS[keys[0]](**dict(legs_with(quantity)[keys[0]](**table))))
    if isinstance(legs[0], Hold):
        raise ConfigError(
            'holds before any value is reached; begin with { to, time, num }, whose time = "0 s" '
            "is a jump",
            "0",
        )
    tables = [leg.model_dump() for leg in legs]
    if (steps := sum(table["num"] * table.get("cycles", 1) for table in tables)) > _MOST:
        raise ConfigError(f"has {excerpt(steps)} load steps; give legs of {_MOST} at most")
    lowest = min(samples_of_legs(legs))
    try:
        quantity(lowest.value)
    except ValueError:
        raise ConfigError(
            f"goes down to {lowest.value:g} {quantity.unit}; it has to stay "
            f"{' and '.join(quantity.bounds)} {quantity.unit}{quantity.hint}",
            str(lowest.leg),
        ) from None
    return tuple(legs)


def samples_of_legs(legs: Sequence[Leg]) -> tuple[Sample, ...]:
    """Return the load steps of a path in legs, which begins at the value 0 at time 0."""
    samples = [Sample(0.0, 0.0, 0)]
    for index, leg in enumerate(legs):
        start, begin, *_ = samples[-1]
        match leg:
            case Move(to=to, time=duration, num=num):
                values = ramp(start, to, num + 1)[1:]
                cycles = [math.nan] * num
            case Hold(hold=duration, num=num):
                values, cycles = [start] * num, [math.nan] * num
            case Oscillation(cycles=count, num=num):
                duration = count / leg.frequency
                # Rounding removes the 1e-16 that sin(π) leaves.
                sine = [round(math.sin(2 * math.pi * n / num), 15) for n in range(num)]
                steps = range(1, count * num + 1)
                values = [float(f"{start + leg.amplitude * sine[n % num]:.15g}") for n in steps]
                cycles = [n / num for n in steps]
            case _:
                assert_never(leg)
        times = ramp(begin, begin + duration, len(values) + 1)[1:]
        samples += map(Sample, values, times, [index] * len(values), cycles)
    return tuple(samples[1:])


@dataclass(frozen=True)
class LoadSteps:
    """Annotation of load steps: one value, a list, or a ramp, which may return to its start."""

    quantity: Quantity
    legs: bool = False
    """Whether a list of legs is allowed too."""

    def __call__(self, spec: object) -> tuple[float, ...] | tuple[Leg, ...]:
        """Return the load steps in order, SI, or their legs."""
        if isinstance(spec, Mapping):
            if self.legs and not KINDS.keys().isdisjoint(spec):
                raise ConfigError("is one leg; give a list of legs, [ { … } ]")
        elif self.legs and is_path(spec):
            entries = list(cast("Iterable[object]", spec))
            if any(isinstance(entry, (Mapping, Leg)) for entry in entries):
                return legs_of(entries, self.quantity)
        return path_of(spec, self.quantity)

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        value_schema = self.quantity.__get_pydantic_json_schema__(schema, handler)
        choices = path_schemas(value_schema)
        if self.legs:
            legs = [kind.model_json_schema() for kind in legs_with(self.quantity).values()]
            choices.append({"type": "array", "items": {"anyOf": legs}, "minItems": 1})
        return {"anyOf": choices}
