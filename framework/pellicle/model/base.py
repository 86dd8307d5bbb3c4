"""The frozen pydantic model that every part of a configuration is, with errors in our words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import (
    BaseModel,
    ConfigDict,
    ValidationError,
)
from pydantic.fields import FieldInfo

from pellicle.errors import ConfigError

from .messages import problems


class Model(BaseModel):
    """Frozen, no unknown fields; raises `ConfigError` that names field, value and remedy."""

    model_config = ConfigDict(extra="forbid", frozen=True, validate_default=False)

    # Positional only: "self" in a file is an unknown field like any other.
    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ConfigError(problems(type(self), error.errors(), data)) from None

    @property
    def described_fields(self) -> Mapping[str, FieldInfo]:
        """The fields by name, with those that only this object has."""
        return type(self).model_fields
