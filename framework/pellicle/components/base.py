"""The base class of all components."""

from __future__ import annotations

from typing import ClassVar

from pellicle.model.base import Model


class Component(Model):
    """A frozen model with a field ``type: Literal["…"]``, by which configurations name it."""

    family: ClassVar[str]
    libraries: ClassVar[tuple[str, ...]] = ()
    """Distributions that it computes with, beside numpy and scipy; results state their versions."""

    @property
    def type_name(self) -> str:
        """The component's type, such as ``half_space``."""
        # A base class with a field ``type: str`` would not let components narrow it to a literal.
        return str(getattr(self, "type", type(self).__name__))
