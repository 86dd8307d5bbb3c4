"""Indenters that transform another indenter."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from pellicle.arrays import Array
from pellicle.components import Footprint, FromRegistry, Indenter
from pellicle.errors import ConfigError


class Transformed(Indenter):
    """An indenter that transforms one other."""

    part: Annotated[
        Indenter,
        FromRegistry(),
        Field(
            examples=[{"type": "sphere", "radius": "10 um"}],
            description="the indenter to change: a table with type",
        ),
    ]

    @property
    def footprint(self) -> Footprint:
        """The footprint of the part."""
        return self.part.footprint


class RigidMotion(Transformed):
    """An indenter that shifts or turns one other, which must be defined beyond the domain."""

    @model_validator(mode="after")
    def _unbounded(self) -> Self:
        if self.part.footprint == "domain":
            raise ConfigError(
                "ends where the domain does and would leave a part of it empty; move the other "
                "parts of a sum instead, or the heights before they are read",
                "part",
            )
        return self


def profile_of(part: Indenter, x: Array, y: Array, field: str) -> Array:
    """Return the profile [m] of the part in ``field``; its errors name that field.

    Raises
    ------
    ConfigError
        The part has no profile on these points.
    """
    try:
        return part.profile(x, y)
    except ConfigError as error:
        raise error.within(field) from None
