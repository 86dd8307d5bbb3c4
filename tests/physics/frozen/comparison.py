"""Values in few numbers, and which of them have changed by more than rounding does."""

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

BLOCKS: Final = 4
"""A field is kept as its means over so many blocks of cells each way, its minimum and maximum."""
COUNT_TOLERANCE: Final = 0.2
"""Share by which counts of iterations and applications may differ."""
COUNTS: Final = ("iterations", "operator_applications")
OF_CELLS: Final = ("contact_area", "contact_fraction", "contact_radius", "perimeter", "semi_")
"""How the names of variables begin that follow from which cells touch, to all digits stored."""
SCALES: Final = {
    "gap": "displacement",
    "force_error": "force",
    "jump_energy": "energy",
    "work": "energy",
    "work_accuracy": "energy",
    "dissipated_energy": "energy",
}
"""Differences, and the number whose size their error has if it is the larger one."""
PURE: Final = ("residual_", "major_axis_angle", "phase", "cycle_drift")
"""How the names of variables begin whose error is absolute."""


def compact(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a run as lists: [step], or [step, block] of a field."""
    values = dict(values)
    major, minor = values["semi_major_axis"], values["semi_minor_axis"]
    is_round = ~(major - minor > 1e-6 * major)
    values["major_axis_angle"] = np.where(is_round, np.nan, values["major_axis_angle"])
    return {name: _numbers(np.asarray(value)) for name, value in values.items()}


def changes(stored: Mapping[str, Any], new: Mapping[str, Any], tolerance: float) -> dict[str, str]:
    """Return what has changed of `compact` values, in words by name.

    Numbers may differ by ``tolerance`` of the largest of their name, or of another (`SCALES`).
    """
    told = {name: "is gone" for name in stored if name not in new}
    told |= {name: "is new" for name in new if name not in stored}
    for name in sorted({*stored} & {*new}):
        old, now = np.array(stored[name]), np.array(new[name])
        if old.shape != now.shape:
            told[name] = f"has {now.shape} values, not {old.shape}"
        elif now.dtype.kind != "f" and name not in COUNTS:
            if (old != now).any():
                told[name] = f"{old.tolist()} → {now.tolist()}"
        else:
            allowed = np.broadcast_to(_allowed(name, stored, old, tolerance), old.shape)
            close = np.isclose(now, old, rtol=0, atol=allowed, equal_nan=True)
            if not close.all():
                told[name] = _worst(old, now, np.where(close, np.nan, allowed))
    return told


def _worst(old: Any, now: Any, allowed: Any) -> str:
    """Return in words the change that exceeds most what is allowed; NaN allows any."""
    with np.errstate(all="ignore"):
        excess = np.where(
            np.isnan(allowed), 0.0, np.nan_to_num(abs(now - old) / allowed, nan=np.inf)
        )
    worst = np.unravel_index(np.argmax(excess), excess.shape)
    place = f" at {[int(index) for index in worst]}" if worst else ""
    return (
        f"{old[worst]:.10g} → {now[worst]:.10g}{place}, {excess[worst]:.3g} times what is allowed"
    )


def _allowed(name: str, stored: Mapping[str, Any], old: Any, tolerance: float) -> Any:
    if name in COUNTS:
        return COUNT_TOLERANCE * old
    if name.startswith(PURE):
        return tolerance
    if name.startswith(OF_CELLS):
        tolerance = 1e-9
    return tolerance * max(_largest(stored[name]), _largest(stored.get(SCALES.get(name, name), [])))


def _largest(values: Any) -> float:
    numbers = np.abs(np.array(values, dtype=float))
    return float(numbers[np.isfinite(numbers)].max(initial=0.0))


def _numbers(array: Any) -> Any:
    if array.ndim == 3:
        array = np.array([_sample(field) for field in array])
    return np.vectorize(_rounded, otypes=[object])(array).tolist()


def _sample(field: Any) -> list[float]:
    rows = [np.array_split(band, BLOCKS, axis=1) for band in np.array_split(field, BLOCKS)]
    return [float(block.mean()) for row in rows for block in row] + [
        float(field.min()),
        float(field.max()),
    ]


def _rounded(value: Any) -> Any:
    # numpy's own scalars have no JSON.
    plain = value.item() if isinstance(value, np.generic) else value
    return float(f"{plain:.10g}") if isinstance(plain, float) else plain
