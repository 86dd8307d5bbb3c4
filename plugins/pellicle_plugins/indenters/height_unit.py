"""The unit of the heights in a file without units."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator

from pellicle.units import Length


def _one_of_it(value: object) -> object:
    """Return ``"1 um"`` for ``"um"``; any other value unchanged."""
    return f"1 {value}" if isinstance(value, str) and value.strip().isalpha() else value


HeightUnit = Annotated[Length, BeforeValidator(_one_of_it, json_schema_input_type=float | str)]
"""A length [m]: ``"um"``, ``"1 um"``, or a number of metres."""
