"""Print fits on the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from .printing import echo, print_columns

if TYPE_CHECKING:
    from pellicle.fitting.result import FitResult
    from pellicle.units import Scale

_WORDS = {
    "youngs_modulus": "Young's modulus",
    "offset": "offset of the baseline",
    "slope": "slope of the baseline",
    "chi_squared": "χ²",
}
_PARAMETERS = (("reduced_modulus", "Pa"), ("tension", "N/m"), ("contact_point", "m"))


def print_fit(fit: FitResult) -> None:
    """Print the estimates of a fit, a line for each curve of a pool, and the fit in words."""
    from pellicle.units import axis_unit

    rows = []
    for name, estimate in fit.estimates().items():
        scale = axis_unit([estimate.value], estimate.unit)
        ends = "fixed" if estimate.held else _interval(estimate.low, estimate.high, scale)
        rows.append((_words(name), scale.number(estimate.value), ends, scale.unit))
    heads = ("parameter", "value", "95 % interval", "unit")
    print_columns(list(zip(heads, zip(*rows, strict=True), strict=True)))
    if curves := fit.curve_rows():
        print_columns([(_words(name), [row[name] for row in curves]) for name in curves[0]])
    for sentence in fit.sentences:
        echo(sentence)
    print_notes(fit)


def print_notes(fit: FitResult) -> None:
    """Print the warnings of a fit."""
    for note in fit.notes:
        echo(f"note: {note}", err=True)


def print_fits(rows: list[dict[str, Any]]) -> None:
    """Print a line for each curve; the table in the folder has their sentences."""
    from pellicle.units import axis_unit

    columns = [("curve", [str(row["curve"]) for row in rows])]
    for name, unit in _PARAMETERS:
        estimates = [row.get(name) for row in rows]
        scale = axis_unit([e["value"] for e in estimates if e], unit)
        values = [scale.number(e["value"]) if e else "" for e in estimates]
        columns.append((f"{_words(name)} [{scale.unit}]", values))
        if name != "contact_point":
            ends = [_interval_of(estimate, scale) for estimate in estimates]
            columns.append((f"95 % of {_words(name)}", ends))
    columns += [
        ("failed checks", [_failed_checks(row) for row in rows]),
        ("notes", [str(len(row.get("messages", ()))) for row in rows]),
        ("status", [str(row["status"]).partition(": ")[0] for row in rows]),
    ]
    print_failures(rows)
    print_columns(columns)


def print_failures(rows: list[dict[str, Any]]) -> None:
    """Print why curves could not be fitted; curves of one reason on one line."""
    reasons: dict[str, list[str]] = {}
    for row in rows:
        if reason := str(row["status"]).partition(": ")[2]:
            reasons.setdefault(reason, []).append(str(row["curve"]))
    for reason, (first, *others) in reasons.items():
        echo(f"{first}{f' and {len(others)} more' if others else ''}: {reason}", err=True)


def _failed_checks(row: Mapping[str, Any]) -> str:
    return ", ".join(check["code"] for check in row.get("failed_checks", ()))


def _interval_of(estimate: Mapping[str, Any] | None, scale: Scale) -> str:
    if not estimate or estimate["held"]:
        return ""
    return _interval(estimate["low"], estimate["high"], scale)


def _interval(low: float | None, high: float | None, scale: Scale) -> str:
    """Return an interval in the unit of the scale, an open end as "open"."""
    return " to ".join("open" if end is None else scale.number(end) for end in (low, high))


def _words(name: str) -> str:
    for key, words in _WORDS.items():
        name = name.replace(key, words)
    return name.replace("_", " ")
