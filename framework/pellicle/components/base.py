"""What all components share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from pellicle.model.base import Model


class Component(Model):
    """What all families share."""

    family: ClassVar[str]
    libraries: ClassVar[tuple[str, ...]] = ()
    """Distributions that it computes with, beside numpy and scipy; results say their versions."""
    replaced_methods: ClassVar[Mapping[str, str]] = {}
    """Methods of an earlier contract, and the method that replaces each; they are refused."""

    @property
    def type_name(self) -> str:
        """The component's type, such as ``half_space``."""
        # A base class with a field ``type: str`` would not let components narrow it to a literal.
        return str(getattr(self, "type", type(self).__name__))
