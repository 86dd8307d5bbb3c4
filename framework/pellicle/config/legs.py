"""Legs of a path in time: to a value, a hold, an oscillation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Annotated, Any, ClassVar, NamedTuple

from pydantic import Field, create_model

from pellicle.errors import ConfigError, all_problems, shown
from pellicle.schema.model import Model
from pellicle.schema.ranges import ramp
from pellicle.units import Quantity

_MOST = 1_000_000
# Three samples are the fewest that show an amplitude and a phase; four meet both extremes.
_FEWEST_OF_CYCLE = 4

Number = Annotated[
    int,
    Field(title="number of steps", ge=1, description="number of load steps of the leg"),
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


class Leg(Model):
    """A part of a path that goes on from the end of the one before, in ``num`` load steps."""

    key: ClassVar[str]
    """The field that only this kind of leg has."""


class Move(Leg):
    """A ramp to a value: { to, time, num }."""

    key: ClassVar[str] = "to"
    to: Annotated[float, Field(title="end value", description="value at the end of the leg")]
    time: Annotated[
        float,
        Quantity("s", at_least=0),
        Field(title="duration", description="duration of the leg [s]; 0 is a jump"),
    ]
    num: Number


class Hold(Leg):
    """A time at the value reached: { hold, num }."""

    key: ClassVar[str] = "hold"
    hold: Annotated[
        float,
        Quantity("s", above=0),
        Field(title="duration", description="duration of the leg [s]"),
    ]
    num: Number


class Oscillation(Leg):
    """A sine about the value reached: { amplitude, frequency, cycles, num }."""

    key: ClassVar[str] = "amplitude"
    amplitude: Annotated[float, Field(description="amplitude of the oscillation")]
    frequency: Annotated[
        float, Quantity("Hz", above=0), Field(description="frequency of the oscillation [Hz]")
    ]
    cycles: Annotated[int, Field(title="number of cycles", ge=1, description="number of cycles")]
    num: Annotated[
        int,
        Field(
            title="steps of a cycle",
            ge=_FEWEST_OF_CYCLE,
            description="number of load steps of each cycle",
        ),
    ]


VALUES = "to", "amplitude"
"""Fields in the unit of the prescription."""
KINDS: tuple[type[Leg], ...] = (Move, Hold, Oscillation)
_FORMS = (
    "{ to, time, num }, { hold, num } or { amplitude, frequency, cycles, num }, with num steps "
    "for each leg, for each cycle of an oscillation"
)


@cache
def with_quantity(kind: type[Leg], quantity: Quantity) -> type[Leg]:
    """Return a kind of leg whose prescribed values have unit and range of ``quantity``.

    It describes, and reads tables; paths hold legs of the three kinds themselves, which pickle.
    """
    allowed = {"to": quantity, "amplitude": Quantity(quantity.unit, above=0)}
    fields: dict[str, Any] = {
        name: (Annotated[float, allowed[name], kind.model_fields[name]], ...)
        for name in allowed.keys() & kind.model_fields.keys()
    }
    return create_model(kind.__name__, __base__=kind, **fields)


def legs_of(entries: Sequence[object], quantity: Quantity) -> tuple[Leg, ...]:
    """Return the legs of a path whose values have the unit and range of ``quantity``."""
    legs: list[Leg] = []
    with all_problems() as within:
        for index, entry in enumerate(entries):
            with within(str(index)):
                legs.append(_leg(entry, quantity))
    if isinstance(legs[0], Hold):
        raise ConfigError(
            'holds before any value is reached; begin with { to, time, num }, whose time = "0 s" '
            "is a jump",
            "0",
        )
    tables = [leg.model_dump() for leg in legs]
    if (steps := sum(table["num"] * table.get("cycles", 1) for table in tables)) > _MOST:
        raise ConfigError(f"has {shown(steps)} load steps; give legs of {_MOST} at most")
    lowest = min(sampled(legs))
    try:
        quantity(lowest.value)
    except ValueError:
        raise ConfigError(
            f"goes down to {lowest.value:g} {quantity.unit}; it has to stay "
            f"{' and '.join(quantity.bounds)} {quantity.unit}{quantity.hint}",
            str(lowest.leg),
        ) from None
    return tuple(legs)


def _leg(entry: object, quantity: Quantity) -> Leg:
    """Return one leg."""
    if isinstance(entry, Leg):
        entry = entry.model_dump()
    if not isinstance(entry, Mapping):
        raise ConfigError(f"{shown(entry)} is not a leg, as others of the list are; give {_FORMS}")
    kinds = [kind for kind in KINDS if kind.key in entry]
    if len(kinds) != 1:
        keys = " and ".join(kind.key for kind in kinds)
        has = f"mixes {keys}" if kinds else f"has {', '.join(map(str, entry)) or 'no key'}"
        raise ConfigError(f"{has}; give {_FORMS}")
    return kinds[0](**dict(with_quantity(kinds[0], quantity)(**entry)))


def sampled(legs: Sequence[Leg]) -> tuple[Sample, ...]:
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
        times = ramp(begin, begin + duration, len(values) + 1)[1:]
        samples += map(Sample, values, times, [index] * len(values), cycles)
    return tuple(samples[1:])
