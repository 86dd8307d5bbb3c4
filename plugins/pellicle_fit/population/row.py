"""One curve of a population: its fit, or why there is none, and whether it counts."""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pellicle import registry
from pellicle.arrays import Array
from pellicle_fit.effect import Effect, Solid, quantities
from pellicle_fit.estimation.intervals import Estimate
from pellicle_fit.files.measurement import Site
from pellicle_fit.record import ENDS, NUMBERS, Record

FITTED = "fitted"
SHOWN = {"reduced_modulus": "E*", "tension": "τ₀", "work_of_adhesion": "W", "thickness": "h"}
"""Symbols of the quantities that tables and figures of curves show, if a curve has them."""
_POINTS = 80
_OF_ONE = {"explanations", "correlations", "excused", "target"}
"""What only the kept file of a fit has: of many curves it would fill the memory."""
_UNPACKED = 1024
"""Records that are held as they are."""


def sketch(**columns: ArrayLike) -> dict[str, Array]:
    """Return evenly chosen rows of a curve, with both ends, as many as a small figure has.

    The columns are position [m], force [N] and, of what was fitted, the force of the fit.
    """
    arrays = {name: np.asarray(values, dtype=float) for name, values in columns.items()}
    rows = np.flatnonzero(np.isfinite(arrays["position"]) & np.isfinite(arrays["force"]))
    rows = rows[np.linspace(0, rows.size - 1, min(rows.size, _POINTS)).round().astype(int)]
    return {name: values[rows].astype("f4") for name, values in arrays.items()}


def as_json(drawn: dict[str, Array]) -> dict[str, list[float]]:
    """Return a sketch as JSON data."""
    return {name: [float(f"{v:.5g}") for v in values] for name, values in drawn.items()}


@lru_cache(_UNPACKED)
def _unpacked(record: bytes) -> Record:
    return Record(json.loads(zlib.decompress(record)) if record else {})


@dataclass(eq=False, slots=True)
class Row:
    """One curve of a population."""

    name: str
    """File, and label in the file."""
    group: str = ""
    map: str = ""
    site: Site | None = None
    failure: str = ""
    """Why there is no fit."""
    kept: str = ""
    """File in the folder of the fits that has all of its own fit."""
    sketch: dict[str, Array] = field(default_factory=dict)
    """Some of its rows, as `sketch` returns them."""
    accepted: bool = False
    reason: str = ""
    outlier: bool = False
    _whole: Record | None = None
    _packed: bytes = b""

    def keep(self, fit: dict[str, Any]) -> None:
        """Take the JSON data of a fit, which may hold a sketch, as workers return them."""
        self._whole = Record({k: value for k, value in fit.items() if k != "sketch"})
        self.sketch = sketch(**fit["sketch"]) if "sketch" in fit else {}

    def pack(self) -> None:
        """Keep in a kilobyte what tables, figures and pages show of the fit, and no more."""
        if self._whole:
            data = {k: value for k, value in self._whole.data.items() if k not in _OF_ONE}
            self._packed, self._whole = zlib.compress(json.dumps(data).encode()), None

    @property
    def fit(self) -> Record:
        """The fit, with r_squared, indentation [m] and largest_force [N], or an empty record."""
        return self._whole or _unpacked(self._packed)

    @property
    def is_fitted(self) -> bool:
        """Whether there is a fit."""
        return bool(self._whole or self._packed)

    @property
    def is_open(self) -> bool:
        """Whether there is neither a fit nor a failure."""
        return not (self.is_fitted or self.failure)

    @property
    def status(self) -> str:
        """`FITTED`, or why there is no fit."""
        return FITTED if self.is_fitted else f"failed: {self.failure}"

    @classmethod
    def of_dict(cls, data: dict[str, Any]) -> Row:
        """Return the row of which `to_dict` returned the data, with its sketch if they hold one."""
        own = {name: data[name] for name in ("group", "failure", "accepted", "reason", "outlier")}
        row = cls(data["curve"], **own)
        row.kept = data.get("kept", "")
        if site := data.get("site"):
            row.map, row.site = site["map"], Site(site["x"], site["y"])
        if not row.failure:
            other = {"curve", "site", "status", "kept", *own}
            row.keep({k: v for k, v in data.items() if k not in other})
            row.pack()
        row.sketch = sketch(**data["sketch"]) if data.get("sketch") else {}
        return row

    def to_dict(self) -> dict[str, Any]:
        """Return the row as JSON data, without the sketch."""
        row: dict[str, Any] = {"curve": self.name, "status": self.status}
        row |= {"failure": self.failure, "group": self.group}
        if self.site is not None:
            row["site"] = {"map": self.map, **self.site._asdict()}
        row |= {"kept": self.kept} if self.kept and self.is_fitted else {}
        judgement = {"accepted": self.accepted, "reason": self.reason, "outlier": self.outlier}
        return row | judgement | self.fit.data


def accepted_estimates(rows: Iterable[Row], name: str) -> dict[Row, Estimate]:
    """Return the estimate of a quantity of each accepted row that has one.

    Intervals of any width count: without the open ones, the stiffest curves would be chosen.  A
    quantity that was given for all curves has none.
    """
    found = {row: e for row in rows if row.accepted and (e := row.fit.best(name)) is not None}
    return {} if all(e.held for e in found.values()) else found


def units() -> dict[str, str]:
    """Return the unit of each of the values of a row, which rules may contain, by name."""
    effects = registry().components.get(Effect.family, {}).values()
    names = {"youngs_modulus": "Pa"}
    for component in (Solid, *(effect.component for effect in effects)):
        names |= {name: quantity.unit for name, quantity in quantities(component).items()}
    return {f"{name}{end}": unit for name, unit in names.items() for end in ENDS} | NUMBERS
