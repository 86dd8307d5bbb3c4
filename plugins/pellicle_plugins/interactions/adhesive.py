"""The fields of interactions that are given by work of adhesion and range or strength."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import ConfigDict, Field, model_validator

from pellicle.components import Interaction
from pellicle.units import Length, Strength, WorkOfAdhesion


class Adhesive(Interaction):
    """An interaction given by its work of adhesion and either its range or its strength."""

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["range"]}, {"required": ["strength"]}]}
    )
    # Work of adhesion over strength times range.
    _SHAPE: ClassVar[float]

    work_of_adhesion: Annotated[
        WorkOfAdhesion, Field(description="energy per area to separate a closed gap [J/m2]")
    ]
    range: Annotated[
        Length | None,
        Field(examples=["20 nm"], description="gap at which the traction ends [m]; or strength"),
    ] = None
    strength: Annotated[
        Strength | None, Field(description="traction that separates a closed gap [Pa]; or range")
    ] = None

    @property
    def reach(self) -> float:
        """The range [m], as given or from the strength."""
        if self.range is not None:
            return self.range
        assert self.strength is not None
        return self.work_of_adhesion / (self._SHAPE * self.strength)

    @property
    def greatest_traction(self) -> float:
        """The strength [Pa], as given or from the range."""
        return self.work_of_adhesion / (self._SHAPE * self.reach)

    @model_validator(mode="after")
    def _range_or_strength(self) -> Self:
        if (self.range is None) == (self.strength is None):
            both = "are both given" if self.range is not None else "are both missing"
            raise ValueError(f"range and strength {both}; give one of them")
        return self
