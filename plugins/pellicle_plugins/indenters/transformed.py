"""What the indenters that are made of others have in common."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from pellicle.arrays import Array
from pellicle.components import Footprint, Indenter
from pellicle.config.component_field import FromRegistry
from pellicle.errors import ConfigError


class Altered(Indenter):
    """An indenter that changes one other."""

    part: Annotated[
        Indenter, FromRegistry(), Field(description="the indenter to change: a table with type")
    ]

    @property
    def footprint(self) -> Footprint:
        """That of the part."""
        return self.part.footprint


class Moved(Altered):
    """An indenter that moves one other, which has to be there wherever it is moved to."""

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
    """Return the profile [m] of the part in ``field``, which its errors then name.

    Raises
    ------
    ConfigError
        The part cannot be put on these points.
    """
    try:
        return part.profile(x, y)
    except ConfigError as error:
        raise error.within(field) from None
