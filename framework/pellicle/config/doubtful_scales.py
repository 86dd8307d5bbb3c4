"""Values of a run whose ratios are so large that a unit is more likely to be missing."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from pellicle.config.loading import Loading
from pellicle.config.run import Run
from pellicle.config.study import Study
from pellicle.schema.model import walk
from pellicle.surface import along_axes
from pellicle.units import Quantity, format_unit, quantity_of, readable

_LARGE = 1.0
"""Edge of a domain [m] beyond which a solid of a modulus above `_STIFF` is doubted."""
_STIFF = 100.0
"""Modulus [Pa] below which all values may be numbers without dimension."""
_LENGTHS = 1e4
"""Largest plausible ratio of a length of the indenter and the domain."""
_ELASTOCAPILLARY = 20.0
"""Largest plausible ratio of tension over modulus and the domain."""
_STICKY = 10.0
"""Largest plausible displacement by adhesion over the domain."""


def doubts_of_scale(configuration: Run | Study) -> dict[str, str]:
    """Return, by path, a message on each value out of scale with the others of its run.

    Of the runs of a study the first that has such a value is quoted.
    """
    if isinstance(configuration, Study):
        runs = [point.run for point in configuration.points]
    else:
        runs = [configuration]
    doubts: dict[str, str] = {}
    for run in runs:
        for path, message in _doubts(run):
            doubts.setdefault(path, message)
    return doubts


def warn_of_scale(configuration: Run | Study) -> None:
    """Warn the caller of the caller of what is out of scale with the rest."""
    for doubt in doubts_of_scale(configuration).values():
        warnings.warn(doubt, stacklevel=4)


def _doubts(run: Run) -> Iterator[tuple[str, str]]:
    size = max(run.grid.size)
    values = _values(run)
    moduli = [value for path, value, unit in values if path[:7] == "kernel." and unit == "Pa"]
    # Displacement by a pressure, both over the whole domain, over its size [1/Pa].
    softness = 0.0
    # A kernel that cannot be evaluated is refused when the run is composed.
    with suppress(Exception), np.errstate(all="ignore"):
        longest = np.array([2 * math.pi / size])
        softness = along_axes(run.kernel.symbol, longest).item() / size
    if size > _LARGE and max(moduli, default=0.0) > _STIFF:
        yield _doubt("grid.size", size, "m")
    for path, value, unit in values:
        part = path.partition(".")[0]
        # Of a line contact the indenter may have any length along the line, heights any unit.
        is_scale = min(run.grid.points) == 1 or path.endswith(".unit")
        if part == "indenter" and unit == "m" and value > _LENGTHS * size and not is_scale:
            yield _doubt(path, value, unit, _on_domain(size))
        if part == "kernel" and unit == "N/m" and moduli:
            length = value / max(moduli)
            if length > _ELASTOCAPILLARY * size:
                over = f"over the modulus {readable(length, 'm', 3)}"
                yield _doubt(path, value, unit, f"{over}, {_on_domain(size)}")
        if part == "interaction" and unit == "J/m2" and value * softness > _STICKY * size:
            yield _doubt(path, value, unit, "which displaces this solid by more than the domain")
        if part == "loading":
            reached = {"m": value / size, "N": value / size**2 * softness, "Pa": value * softness}
            if reached.get(unit, 0.0) > 1.0 and not (unit == "m" and _has_spring(run)):
                yield _doubt(path, value, unit, _on_domain(size))


def _on_domain(size: float) -> str:
    return f"on a domain of {readable(size, 'm', 3)}"


def _has_spring(run: Run) -> bool:
    """Return whether a spring, however soft, takes up most of what is prescribed."""
    prescription = run.indentation.loading.prescription
    quantities = map(quantity_of, type(prescription).model_fields.values())
    return any(quantity.unit == "N/m" for quantity in quantities if quantity)


def _values(run: Run) -> list[tuple[str, float, str]]:
    """Return path, largest size and unit of the numbers of a run that are not 0."""
    values = []
    for path, value, field in walk(run):
        if field is None or path[-1].isdecimal() or path.startswith("loading."):
            continue
        if not isinstance(value, (float, tuple, list)) or not (quantity := quantity_of(field)):
            continue
        several = [value] if isinstance(value, float) else value
        if numbers := [abs(v) for v in several if isinstance(v, float) and v]:
            values.append((path, max(numbers), quantity.unit))
    if isinstance(loading := run.loading, Loading):
        largest, unit = max(map(abs, loading.values)), loading.prescription.unit
        values.append((f"loading.{loading.prescribed}", largest, unit))
    return values


def _doubt(path: str, value: float, unit: str, reason: str = "") -> tuple[str, str]:
    number, usual = f"{value:g}", str(Quantity(unit).example).partition(" ")[2]
    because = f", {reason}" if reason else ""
    return path, (
        f"{path} is {number} {format_unit(unit)}{because}; a number without a unit is in SI: "
        f"give one, such as '{number} {usual}', if that is not meant"
    )
