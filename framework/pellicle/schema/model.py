"""The base class of all configuration: a frozen pydantic model that raises `ConfigError`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo

from pellicle.errors import ConfigError

from .messages import problems


class Model(BaseModel):
    """A frozen model that refuses unknown fields with a `ConfigError` naming field and remedy."""

    model_config = ConfigDict(extra="forbid", frozen=True, validate_default=False)

    # Positional only, so that a key "self" in a file is refused as an unknown field.
    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ConfigError(problems(type(self), error.errors(), data)) from None

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy with the fields of ``update``, which are not validated."""
        copy = super().model_copy(update=update, deep=deep)
        # Cached properties are those of the fields before the update.
        for name in copy.__dict__.keys() - type(self).model_fields.keys():
            del copy.__dict__[name]
        return copy

    @property
    def entries(self) -> Mapping[str, tuple[Any, FieldInfo]]:
        """Value and description of each key of its table in a file."""
        return {name: (getattr(self, name), info) for name, info in type(self).model_fields.items()}
