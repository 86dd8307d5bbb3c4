"""What all components share."""

from __future__ import annotations

from typing import ClassVar

from pellicle.model.base import Model


class Component(Model):
    """What all families share."""

    family: ClassVar[str]
    libraries: ClassVar[tuple[str, ...]] = ()
    """Distributions that it computes with, beside numpy and scipy; results say their versions."""
