"""A map of traction from a file or an array."""

from __future__ import annotations

import hashlib
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from pellicle.arrays import Array
from pellicle.components import Load
from pellicle.schema import InputPath
from pellicle.units import Quantity
from pellicle_plugins.indenters.from_heights import FromArray, length_of
from pellicle_plugins.indenters.heights import array_in, checked_array, one_source, require_shape

_Unit = Annotated[float, Quantity("Pa", above=0)]


class Map(FromArray, Load):
    """Traction on each cell, computed elsewhere or measured, such as by traction microscopy.

    In Python, ``values`` takes an array instead of a file; the configuration then records only its
    hash, that of the values as float64 in C order.
    """

    type: Literal["map"] = "map"
    examples = ({"path": "traction.txt", "unit": "1 Pa"},)
    content: ClassVar[str] = "tractions"
    path: InputPath | None = Field(
        None,
        title="file",
        description="file with a 2-D array [along x, along y] of tractions, positive into the "
        "solid: .npy, text (.txt, .csv, .dat), .h5 or .mat",
    )
    unit: Annotated[_Unit, BeforeValidator(length_of, json_schema_input_type=float | str)] = Field(
        description="traction that a 1 in the data stands for [Pa]: 'kPa'"
    )
    dataset: str | None = Field(None, description="name of the array in a file that holds several")
    values: Annotated[
        Any,
        AfterValidator(
            lambda raw: None if raw is None else checked_array(raw, "the array", "", "tractions")
        ),
    ] = Field(None, description="array of tractions, from the library", exclude=True, repr=False)

    @model_validator(mode="after")
    def _read(self) -> Self:
        one_source(self.path, self.values, self.sha256)
        values, name = self.values, "the array"
        if self.path is not None:
            name = str(self.path)
            values = checked_array(array_in(self.path, self.dataset), name, "path", "tractions")
        self._keep(values, hashlib.sha256(values.tobytes()).hexdigest(), name)
        return self

    def traction(self, x: Array, y: Array) -> Array:
        """Return values · unit [Pa]; the grid is of the shape of the array."""
        shape = np.broadcast_shapes(x.shape, y.shape)
        name, field = (str(self.path), "path") if self.path else ("the array", "values")
        require_shape(self._values.shape, shape, name, field)
        traction: Array = self._values * self.unit
        return traction
