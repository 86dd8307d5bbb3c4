"""Stiffening with depth."""

from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from pellicle.units import Quantity
from pellicle_fit.effect import Bends, Fitted, fitted


class Stiffening(Bends):
    """Gel that stiffens with depth: F (1 + (δ/d)ⁿ) in place of F."""

    type: Literal["stiffening"] = "stiffening"
    examples = ({}, {"stiffening_depth": "2 um", "power": 2})
    rank = 2
    stiffening_depth: Annotated[float, Fitted("m", above=0, log=True)] = fitted("depth d [m]")
    power: Annotated[float, Quantity("1", above=0), Field(description="power n")] = 1.0

    def contact(self, contact):
        """Return the contact of the gel."""

        def area(depth, length):
            return contact.area(depth, length) * (
                1 + (depth.clip(0) / self.stiffening_depth) ** self.power
            )

        return replace(contact, area=area, half_space=False)
