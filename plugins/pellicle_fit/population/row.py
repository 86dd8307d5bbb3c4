"""One curve of a population: its fit, or why there is none, and whether it counts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Self

import numpy as np

from pellicle.arrays import Array
from pellicle_fit.files.measurement import Site
from pellicle_fit.intervals import Estimate

FITTED = "fitted"
FAILED = "failed: "
NOT_RUN = "not run"
NUMBERS = {
    "r_squared": "1",
    "chi_squared": "1",
    "points": "1",
    "noise": "N",
    "indentation": "m",
    "largest_force": "N",
    "lead": "1",
    "tension_needed": "1",
    "failed_checks": "1",
    "messages": "1",
}
"""Unit of each number of a fit that is not a quantity of it; checks and messages are counted."""
ENDS = "", "_low", "_high"
"""What the names of value and ends of an interval end with."""
_OVER_TIED = "reduced_modulus", "youngs_modulus", "tension"
"""Quantities whose intervals are over all explanations that the curve cannot tell apart."""
_POINTS, _DIGITS = 80, 5


class Sketch(NamedTuple):
    """Position [m] and force [N] of some rows of a curve, and the force of the fit there."""

    position: Array
    force: Array
    fit: Array | None = None

    @classmethod
    def of(cls, position: Array, force: Array, fit: Array | None = None) -> Self:
        """Return evenly chosen rows, with the first and the last, as many as a small figure has."""
        z, f = (np.asarray(values, dtype=float) for values in (position, force))
        rows = np.flatnonzero(np.isfinite(z) & np.isfinite(f))
        rows = rows[np.linspace(0, rows.size - 1, min(rows.size, _POINTS)).round().astype(int)]
        model = None if fit is None else np.asarray(fit)[rows].astype("f4")
        return cls(z[rows].astype("f4"), f[rows].astype("f4"), model)

    def to_dict(self) -> dict[str, list[float]]:
        """Return it as JSON data, rounded."""
        lists = {name: v for name, v in self._asdict().items() if v is not None}
        return {name: [float(f"{v:.{_DIGITS}g}") for v in values] for name, values in lists.items()}


@dataclass(eq=False)
class Row:
    """One curve of a population."""

    name: str
    """File, and label in the file."""
    group: str = ""
    map: str = ""
    """File of the force map that it belongs to."""
    site: Site | None = None
    """Where on the map it was measured."""
    status: str = NOT_RUN
    """`FITTED`, or why there is no fit."""
    fit: dict[str, Any] = field(default_factory=dict)
    """JSON data of the fit, with r_squared, indentation [m] and largest_force [N]."""
    sketch: Sketch | None = None
    accepted: bool = False
    reason: str = ""
    """Why it is not accepted."""
    outlier: bool = False
    """Whether its modulus stands out from that of its group."""
    estimates: dict[str, Estimate] = field(default_factory=dict, init=False)
    """Modulus and tension over all that is tied, and the quantities of the chosen explanation."""
    numbers: dict[str, float] = field(default_factory=dict, init=False)
    """`NUMBERS` of the fit, in SI."""

    def __post_init__(self) -> None:
        if self.fit:
            self.keep(self.fit)

    def keep(self, fit: dict[str, Any]) -> None:
        """Take the JSON data of a fit, which may hold a sketch, as workers return them."""
        self.fit = {name: value for name, value in fit.items() if name != "sketch"}
        if "sketch" in fit:
            self.sketch = Sketch.of(**fit["sketch"])
        (curve,) = fit["curves"]
        of_curve = {"points": curve["points"], "noise": curve["noise"]["value"]}
        counts = {"failed_checks": len(curve["failed_checks"]), "messages": len(fit["messages"])}
        found = fit | of_curve | counts
        self.numbers = {name: _number(found.get(name)) for name in NUMBERS}
        headline = {name: fit[name] for name in _OVER_TIED if name in fit}
        # Modulus and tension come first.
        parameters = {**headline, **fit["parameters"], **headline}
        self.estimates = {name: Estimate(**entry) for name, entry in parameters.items()}
        self.status = FITTED

    @property
    def is_fitted(self) -> bool:
        """Whether there is a fit."""
        return self.status == FITTED

    def is_closed(self, name: str) -> bool:
        """Return whether the chosen explanation has both ends of the interval of a quantity.

        The value of an open interval is one of many that describe the curve as well.
        """
        own = self.fit.get("parameters", {}).get(name.replace("youngs", "reduced"))
        return own is not None and not own["held"] and None not in (own["low"], own["high"])

    def values(self) -> dict[str, float]:
        """Return all numbers in SI by name, ends of intervals too; an open end is NaN."""
        values: dict[str, float] = {}
        for name, estimate in self.estimates.items():
            numbers = estimate.value, estimate.low, estimate.high
            names = (f"{name}{end}" for end in ENDS)
            values |= dict(zip(names, map(_number, numbers), strict=True))
        return values | self.numbers

    @property
    def model(self) -> str:
        """The effects of the chosen explanation in words; empty without a fit."""
        return str(self.fit["model"]["words"]) if self.fit else ""

    @property
    def verdict(self) -> str:
        """Whether what was asked for is needed; empty without a fit."""
        return str(self.fit.get("verdict", ""))

    @property
    def messages(self) -> list[str]:
        """Warnings and notes of the fit."""
        return list(self.fit.get("messages", ()))

    @property
    def _curve(self) -> dict[str, Any]:
        return dict(next(iter(self.fit.get("curves", ())), {}))

    @property
    def failed_checks(self) -> list[str]:
        """Codes of the checks that its residuals fail."""
        return [check["code"] for check in self._curve.get("failed_checks", ())]

    @property
    def data(self) -> dict[str, Any]:
        """Origin of the curve, and which part of it was fitted; empty without a fit."""
        return dict(self._curve.get("data", {}))

    @property
    def radius(self) -> float | str:
        """Radius of the indenter [m]; an empty text if it has none, or without a fit."""
        radius: float | str = self._curve.get("indenter", {}).get("radius", "")
        return radius

    def to_dict(self) -> dict[str, Any]:
        """Return the row as JSON data, without the sketch."""
        row: dict[str, Any] = {"curve": self.name, "status": self.status, "group": self.group}
        if self.site is not None:
            row["site"] = {"map": self.map, **self.site._asdict()}
        judgement = {"accepted": self.accepted, "reason": self.reason, "outlier": self.outlier}
        return row | judgement | self.fit

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """Return the row that JSON data hold, without its place on a map."""
        fit = {name: value for name, value in data.items() if name != "site"}
        name, group, status = (fit.pop(key) for key in ("curve", "group", "status"))
        own = {key: fit.pop(key) for key in ("accepted", "reason", "outlier")}
        return cls(name, group, status=status, fit=fit, **own)


def units_of(rows: Iterable[Row]) -> dict[str, str]:
    """Return the unit of each of the values of rows by name."""
    units = dict(NUMBERS)
    for row in rows:
        for name, estimate in row.estimates.items():
            units |= {f"{name}{end}": estimate.unit for end in ENDS}
    return units


def _number(value: float | None) -> float:
    return np.nan if value is None else float(value)
