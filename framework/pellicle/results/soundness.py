"""Whether the content of a file is that of a result: types, dimensions, texts of JSON, caveats."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from math import isnan
from pathlib import Path
from typing import Final

from pellicle.arrays import Dataset
from pellicle.contact.caveats import Status, from_text
from pellicle.errors import ConfigError, StorageError
from pellicle.grid import Grid
from pellicle.variables import CAVEATS, COORDINATES, VARIABLES, WALL_PRESSURE

from .derived import DERIVED, VARYING, configuration_of

_KINDS: Final = {"number": "fiu", "count": "fiu", "truth": "b", "text": "OUT"}
"""Kinds of numpy types for each type of a variable."""

_CELLS: Final = {"x": "f", "y": "f"}


@contextmanager
def sound(path: Path) -> Iterator[None]:
    """Raise a `StorageError` if what is read in the block has another type or form."""
    try:
        yield
    except (
        *(TypeError, ValueError, LookupError, AttributeError, ArithmeticError),
        *(RecursionError, ConfigError),
    ):
        raise StorageError(
            f"{path}: its numbers, texts or configuration are not those of a result, so it is "
            "damaged; run it again"
        ) from None


def check(data: Dataset) -> None:
    """Read what is taken from a result, or from the table of a study, and raise what comes of it.

    Raises
    ------
    TypeError, ValueError, LookupError, AttributeError, ArithmeticError, ConfigError
        A value has another type, dimension or form.
    """
    is_table, attributes = "axes" in data.attrs, data.attrs
    coordinates = {name: data[name].dtype.kind for name in COORDINATES if name in data.coords}
    if not data.sizes["step"] or coordinates != {"step": "i"} | ({} if is_table else _CELLS):
        raise ValueError("coordinates")
    shape = Grid(**configuration_of(data)["grid"]).shape
    if not is_table and shape != (data.sizes["x"], data.sizes["y"]):
        raise ValueError("grid")
    for name, variable in data.data_vars.items():
        described = VARIABLES.get(str(name))
        if described and described.kind not in ("path", "oscillation"):
            is_field = described.kind == "field" or name == WALL_PRESSURE
            dims = COORDINATES[: 3 if is_field else 1]
            kind = variable.dtype.kind
            if kind not in _KINDS[described.type] or variable.dims[-len(dims) :] != dims:
                raise ValueError(name)
    for caveat in (c for text in data[CAVEATS].values.ravel() for c in from_text(text)):
        _ = caveat.sentence
    _ = [Status[code] for code in data["status_code"].values.ravel() if code]
    _ = int(attributes["planned_steps"]), isnan(attributes["tolerance"])
    _ = [attributes[name].strip() for name in ("boundary", "prescribed", "title")]
    if is_table:
        if data["run"].dims != data["status"].dims[:-1]:
            raise ValueError("run")
        _ = [name[:1] for name in data["run"].values.ravel()], [*json.loads(attributes[VARYING])]
        _ = {**json.loads(attributes[DERIVED]), **json.loads(attributes["axes"])}
