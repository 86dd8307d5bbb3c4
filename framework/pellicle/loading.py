"""The load steps of a run: what is prescribed, and the path that it takes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sized
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, cast, get_args

from pydantic import Field, model_validator
from pydantic_core import core_schema

from .errors import ConfigError, Problem, shown
from .model.base import Model
from .model.ranges import RANGE, SPACINGS, ranged
from .units import Quantity

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.json_schema import JsonSchemaValue

Prescribed = Literal[
    "depth", "force", "mean_pressure", "mean_plane_depth", "contact_radius", "contact_area"
]


@dataclass(frozen=True)
class _Steps:
    """Annotation of load steps: one value, a list, or a ramp, which may go back again."""

    quantity: Quantity

    def __call__(self, given: object) -> tuple[float, ...] | None:
        if given is None:
            return None
        if isinstance(given, Mapping):
            return self._ramp(given)
        # Anything with a length but text: lists, tuples, arrays.
        several = isinstance(given, Sized) and not isinstance(given, str)
        values = list(cast("Iterable[object]", given)) if several else [given]
        if not values:
            raise ValueError("is empty; give at least one load step")
        return self._all({str(i) if several else "": value for i, value in enumerate(values)})

    def _ramp(self, given: Mapping[Any, Any]) -> tuple[float, ...]:
        back = given.get("back", False)
        if not isinstance(back, bool):
            raise ConfigError(f"{shown(back)} is not allowed; give true or false", "back")
        once = {key: value for key, value in given.items() if key != "back"}
        ends = self._all({end: once[end] for end in ("start", "stop") if end in once})
        once |= zip([end for end in ("start", "stop") if end in once], ends, strict=True)
        there = ranged(once, "ramp", 'back = true or spacing = "log"')
        return there + there[-2::-1] if back else there

    def _all(self, given: Mapping[str, object]) -> tuple[float, ...]:
        """Return every value in SI, or raise with all that are not allowed."""
        values, problems = [], []
        for where, value in given.items():
            try:
                values.append(self.quantity(value))
            except ValueError as error:
                problems.append(Problem(where, str(error)))
        if problems:
            raise ConfigError(problems)
        return tuple(values)

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        one = self.quantity.__get_pydantic_json_schema__(schema, handler)
        ramp = {
            "type": "object",
            "properties": {
                "start": one,
                "stop": one,
                "num": {"type": "integer", "minimum": 2},
                "spacing": {"enum": list(SPACINGS)},
                "back": {"type": "boolean"},
            },
            "required": sorted(RANGE),
            "additionalProperties": False,
        }
        return {"anyOf": [one, {"type": "array", "items": one, "minItems": 1}, ramp]}


class Loading(Model):
    """The load steps: exactly one quantity is prescribed, in the order of its path.

    A value, a list, or a ramp ``{start, stop, num}`` with ``spacing = "log"`` if need be; with
    ``back = true`` the ramp goes back to its start by the same values.
    """

    depth: Annotated[
        tuple[float, ...] | None,
        _Steps(Quantity("m", at_least=0)),
        Field(
            description="depth of the indenter's lowest point [m] below the undeformed surface, "
            "or below the mean plane on a periodic grid, unless the kernel is a layer or springs; "
            "0 at first touch"
        ),
    ] = None
    force: Annotated[
        tuple[float, ...] | None,
        _Steps(Quantity("N", at_least=0)),
        Field(description="force on the domain [N]"),
    ] = None
    mean_pressure: Annotated[
        tuple[float, ...] | None,
        _Steps(Quantity("Pa", at_least=0)),
        Field(description="force over the area of a periodic domain [Pa]"),
    ] = None
    mean_plane_depth: Annotated[
        tuple[float, ...] | None,
        _Steps(Quantity("m")),
        Field(
            description="depth of the mean plane of the indenter's heights [m], from where depth "
            "is measured; negative where the mean plane is above"
        ),
    ] = None
    contact_radius: Annotated[
        tuple[float, ...] | None,
        _Steps(Quantity("m", at_least=0)),
        Field(description="radius [m] of the circle of the same area as the cells in contact"),
    ] = None
    contact_area: Annotated[
        tuple[float, ...] | None,
        _Steps(Quantity("m**2", at_least=0)),
        Field(description="area of the cells in contact [m²], met to the nearest whole cells"),
    ] = None
    stiffness: Annotated[
        bool,
        Field(
            description="whether each step says its contact stiffness dF/dδ; costs one more "
            "linear solve a step"
        ),
    ] = False

    @model_validator(mode="after")
    def _one_prescription(self) -> Self:
        known = get_args(Prescribed)
        given = [name for name in known if getattr(self, name) is not None]
        if len(given) != 1:
            what = f"prescribes {' and '.join(given)}" if given else "prescribes nothing"
            raise ValueError(f"{what}; give exactly one of {', '.join(known)}")
        return self

    @property
    def prescribed(self) -> Prescribed:
        """The name of what is prescribed."""
        return next(name for name in get_args(Prescribed) if getattr(self, name) is not None)

    @property
    def values(self) -> tuple[float, ...]:
        """The load steps in order, SI."""
        values: tuple[float, ...] = getattr(self, self.prescribed)
        return values

    @property
    def brings(self) -> set[str]:
        """The variables of a result that are there for this loading and not for every one."""
        by_area = self.prescribed in ("contact_radius", "contact_area")
        brought = {"residual_area"} if by_area else {self.prescribed} & ON_DEMAND
        return brought | ({"stiffness"} if self.stiffness else set())


ON_DEMAND = {"mean_plane_depth", "residual_area", "stiffness"}
"""The variables of a result that only some loadings bring."""
