"""What indenters whose heights come from outside have in common."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field, PrivateAttr

from pellicle.arrays import Array
from pellicle.components import Footprint, Indenter
from pellicle.errors import ConfigError


class Measured(Indenter):
    """Rough punch given by heights; peaks touch first, it ends at the edge of the domain."""

    footprint: ClassVar[Footprint] = "domain"

    sha256: Annotated[
        str | None,
        Field(description="hash of what was read; checked if given"),
    ] = None
    _heights: Array = PrivateAttr()

    def _keep(self, heights: Array, digest: str) -> None:
        """Keep the heights that were read, and the hash of what they were read from."""
        if self.sha256 is not None and self.sha256 != digest:
            raise ConfigError(
                f"{self.sha256} is not the hash {digest} of the heights: they have changed; remove "
                "sha256 to use them as they are",
                "sha256",
            )
        heights.setflags(write=False)
        # The model is frozen for its users; this is still its construction.
        object.__setattr__(self, "sha256", digest)
        self._heights = heights

    def __eq__(self, other: object) -> bool:
        """Compare the configuration; the hash stands for the heights."""
        return type(other) is type(self) and self.model_dump() == other.model_dump()

    def __hash__(self) -> int:
        """Return a hash that agrees with equality."""
        return hash((type(self), self.sha256))
