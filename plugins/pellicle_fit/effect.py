"""The contract of effects: what a measured curve has beside or instead of an elastic half-space.

An effect is a component in one of five places. What a set of effects makes of a curve is::

    recorded = Records( F ),  F = Responds[Bends(contact)](path, δ) + Σ Adds(δ)
    δ = base − contact point − Σ Yields(F)

Of a place, effects act in the order of their `rank`; the cantilever is the first that yields.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import core_schema

from pellicle.arrays import Array as Array
from pellicle.components import Component
from pellicle.units import Quantity, quantity_of

from .contact.contact import Contact as Contact
from .contact.curve import Curve as Curve

ComplexArray = NDArray[np.complex128]
"""Complex numbers."""
Values = Mapping[str, float]
"""Values [SI] of quantities by name."""


class Weighed(float):
    """A quantity that is known from elsewhere, to a standard deviation [SI]: one more datum."""

    deviation: float


@dataclass(frozen=True)
class Fitted(Quantity):
    """Annotation of a quantity: left out it is fitted, given it is held.

    Given as ``{ value = "3 um", deviation = "0.1 um" }`` it is fitted and weighed.

    Parameters
    ----------
    log
        Whether a search varies its logarithm.
    scope
        What has a value of its own in a pool: all curves share one, those of each indenter, or each
        curve has one.
    starts
        Values from which searches start, over the size that such a quantity has in a curve.
    limits
        Between which values, over that size, a curve can tell anything of it.
    """

    left_out: ClassVar[str] = "fitted"
    log: bool = False
    scope: Literal["all", "indenter", "curve"] = "all"
    starts: tuple[float, ...] = (0.1,)
    limits: tuple[float, float] | None = None

    def given(self, value: object) -> float | None:
        """Return a value in SI, `Weighed` if it comes with a deviation; None if it is left out."""
        if value is None or isinstance(value, Weighed):
            return value
        if not isinstance(value, Mapping):
            return self(value)
        if value.keys() != {"value", "deviation"}:
            raise ValueError(f"{dict(value)} is not of the form {{ value = …, deviation = … }}")
        weighed = Weighed(self(value["value"]))
        weighed.deviation = Quantity(self.unit, above=0)(value["deviation"])
        return weighed

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(
            self.given,
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda v: {"value": float(v)} | vars(v) if isinstance(v, Weighed) else v
            ),
        )

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        number = super().__get_pydantic_json_schema__(schema, handler)
        deviation = Quantity(self.unit, above=0).__get_pydantic_json_schema__(schema, handler)
        parts = {"value": number, "deviation": deviation}
        weighed = {"properties": parts, "required": [*parts], "additionalProperties": False}
        return {"anyOf": [number, {"type": "object"} | weighed], "unit": self.unit}


def fitted(description: str) -> Any:
    """Return the field of a quantity annotated with `Fitted`.

    It is annotated as ``float``: the methods of a component are called with all of them known.
    """
    return Field(default=None, description=description)


class Fittable(Component):
    """A component with quantities that a fit determines."""

    @property
    def open(self) -> Mapping[str, Fitted]:
        """The quantities that a fit determines, by name."""
        own = {name: (q, getattr(self, name)) for name, q in quantities(type(self)).items()}
        return {name: q for name, (q, v) in own.items() if v is None or isinstance(v, Weighed)}

    def at(self, values: Values) -> Self:
        """Return the component with values of its open quantities."""
        return self.of_values({name: values[name] for name in self.open})

    def of_values(self, values: Mapping[str, Any]) -> Self:
        """Return the component with values of some quantities, as often as a search asks."""
        known = type(self).__new__(type(self))
        state = {**self.__getstate__(), "__dict__": {**self.__dict__, **values}}
        known.__setstate__(state)
        return known


@cache
def quantities(component: type[Component]) -> Mapping[str, Fitted]:
    """Return the quantities of a component by name."""
    infos = {name: quantity_of(info) for name, info in component.model_fields.items()}
    return {name: q for name, q in infos.items() if isinstance(q, Fitted)}


class Solid(Fittable):
    """Elastic half-space, and where the indenter touches it first."""

    family: ClassVar[str] = "solid"
    reduced_modulus: Annotated[float, Fitted("Pa", above=0, log=True)] = fitted(
        "reduced modulus E*"
    )
    contact_point: Annotated[float, Fitted("m", scope="curve")] = fitted("position of first touch")


class Sizes(NamedTuple):
    """Orders of magnitude of a curve, from which searches start."""

    length: float
    """Range of positions [m]."""
    force: float
    """Range of forces [N]."""
    time: float
    """Duration [s]; 1 without times."""
    rows: int
    shallow_force: float = 0.0
    """Force before contact [N]."""

    @classmethod
    def of_curve(cls, curve: Curve) -> Sizes:
        """Return those of a curve."""
        time = 1.0 if curve.time is None else float(curve.time[-1] - curve.time[0])
        return cls(curve.span, curve.largest, time, curve.position.size, curve.shallow_force)

    def of(self, unit: str) -> float:
        """Return the order of magnitude of a quantity with a unit."""
        newton, metre, second = powers(unit)
        return self.force**newton * self.length**metre * self.time**second


@cache
def powers(unit: str) -> tuple[int, int, int]:
    """Return the powers of N, m and s in a unit."""
    return Quantity(unit).powers()


class Effect(Fittable):
    """What bends a measured curve beside or instead of an elastic half-space."""

    family: ClassVar[str] = "effect"
    place: ClassVar[str] = "rivals[]"
    rank: ClassVar[int] = 0
    """Order in which effects of one place act."""
    holds_modulus: ClassVar[bool] = True
    """Whether E* beside it is that of the solid, and not up to an unknown factor."""
    jumps: ClassVar[bool] = False
    """Whether its force may jump from row to row, so that no mean stands for rows."""
    absorbed: ClassVar[str] = ""
    """What makes up for its quantities, so that they need deviations; empty if nothing does."""

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Return why it cannot act on a curve beside effects of some types; empty if it can.

        ``contact`` is what it acts on, of modulus 1 Pa: bent by those that bend it before.
        """
        free = not all(isinstance(getattr(self, name), Weighed) for name in self.open)
        return f"needs a deviation: {self.absorbed}" if self.absorbed and free else ""

    def starts(self, sizes: Sizes) -> Iterable[Values]:
        """Yield values of its quantities from which searches start."""
        scales = {name: sizes.of(quantity.unit) for name, quantity in self.open.items()}
        for shares in product(*(quantity.starts for quantity in self.open.values())):
            pairs = zip(scales.items(), shares, strict=True)
            yield {name: share * scale for (name, scale), share in pairs}

    def known(self, sizes: Sizes) -> Self:
        """Return it with its open quantities at the first of its starts."""
        usual = next(iter(Effect.starts(self, sizes)))
        return self.at({**usual, **next(iter(self.starts(sizes)), {})})

    def limits(self, sizes: Sizes) -> Mapping[str, tuple[float, float]]:
        """Return between which values [SI] such a curve can tell anything of a quantity."""
        known = {name: (q.limits, sizes.of(q.unit)) for name, q in self.open.items()}
        return {n: (ends[0] * size, ends[1] * size) for n, (ends, size) in known.items() if ends}

    def accuracy(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> float:
        """Return the error of its force over the largest one; intervals are wider by it."""
        return 0.0

    def searched(self, curve: Curve) -> int:
        """Return as how many quantities criteria count its discrete choices in a curve."""
        return 0


class Bends(Effect):
    """Another contact than that of the indenter with a half-space; one in a set per rank.

    The ranks are 0 for a size, 1 for a shape, 2 for a layer, 3 for a skin.
    """

    @abstractmethod
    def contact(self, contact: Contact) -> Contact:
        """Return the contact that takes the place of another."""


Response = Callable[[Array], Array]
"""Force [N] of each row at its depth [m], both of shape (n,), row by row."""


class Responds(Effect):
    """A force from the whole path; at most one in a set, and none is elastic."""

    balances: ClassVar[bool] = False
    """Whether depths and path are those of the base, and it finds where a cantilever balances."""

    @abstractmethod
    def response(self, contact: Contact, curve: Curve, path: Array, softness: float) -> Response:
        """Return the force as a function of the depth, after a path of depths [m], shape (n,).

        The path is that of the measured forces; what depends on it alone is computed once.
        ``softness`` is that of the cantilever [m/N], for an effect that `balances`.
        """

    def relaxed(self, time: float) -> float:
        """Return the modulus after a time [s] over E*."""
        return 1.0

    def complex_modulus(
        self, frequency: Array, radius: Array, length: Array | float
    ) -> ComplexArray | None:
        """Return E*(ω)/E* of a contact that stays at frequencies [Hz]; None if it has none.

        Its radii [m] are those without tension, and ``length`` is s = 2τ₀/E* [m].
        """
        return None


class Adds(Effect):
    """A force beside that of the solid; any number in a set."""

    @abstractmethod
    def force(self, contact: Contact, curve: Curve, depth: Array) -> Array:
        """Return the force [N] of each row at depths [m]."""


class Yields(Effect):
    """A body in series with the solid, as the cantilever is; any number in a set."""

    @abstractmethod
    def give(self, force: Array) -> Array:
        """Return by how much it gives way [m] under forces [N].

        With all that yields, the depth of the base has to grow with that of the solid.
        """


class Records(Effect):
    """What the instrument makes of a force; any number in a set."""

    @abstractmethod
    def recorded(self, force: Array, curve: Curve) -> Array:
        """Return the force [N] that is recorded."""

    def stiffness(self, stiffness: float) -> float:
        """Return the true spring constant [N/m] where the recorded force assumes another."""
        return stiffness
