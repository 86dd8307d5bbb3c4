"""The base class of all configuration: a frozen pydantic model with errors in our words."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from pellicle.errors import ConfigError

from .messages import problems


class Model(BaseModel):
    """A frozen model without unknown fields; raises `ConfigError`, which names field and remedy."""

    model_config = ConfigDict(extra="forbid", frozen=True, validate_default=False)

    # Positional only, so that a key "self" in a file is refused as an unknown field.
    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ConfigError(problems(type(self), error.errors(), data)) from None
