"""Names, units and intervals of what a fit determines, as people read them."""

from __future__ import annotations

from collections.abc import Sequence

from pellicle.units import Scale, axis_unit, printed

from .intervals import Estimate

_WORDS = {
    "youngs_modulus": "Young's modulus",
    "offset": "offset of the baseline",
    "slope": "slope of the baseline",
    "chi_squared": "χ²",
}


def words(name: str) -> str:
    """Return the name of a parameter or a key in words."""
    for key, text in _WORDS.items():
        name = name.replace(key, text)
    return name.replace("_", " ")


def scale(estimate: Estimate, *, si: bool = False) -> Scale:
    """Return the unit for the value and the ends of an estimate, with a prefix unless ``si``."""
    ends = [end for end in (estimate.low, estimate.high) if end is not None]
    # The value of an interval that is open to one side is not shown.
    values = ends if len(ends) == 1 or not estimate.value else [estimate.value]
    return column_scale(values, estimate.unit, si=si)


def column_scale(values: Sequence[float], unit: str, *, si: bool = False) -> Scale:
    """Return the unit of a column of values in SI, with one prefix unless ``si``."""
    if si:
        return Scale(1.0, "" if unit == "1" else printed(unit))
    return axis_unit(values, unit)


def interval_text(low: float | None, high: float | None, scale: Scale) -> str:
    """Return an interval in the unit of a column, an open end as "open"."""
    return " to ".join("open" if end is None else scale.number(end) for end in (low, high))


def interval(estimate: Estimate, *, si: bool = False) -> str:
    """Return an interval in the unit of `scale`; of an open one the end that it has."""
    unit_scale = scale(estimate, si=si)
    if estimate.held:
        return "fixed"
    low, high = (
        None if end is None else unit_scale.number(end) for end in (estimate.low, estimate.high)
    )
    if low is None and high is None:
        return "open"
    if low is None:
        return f"< {high}"
    return f"> {low}" if high is None else f"{low} to {high}"


def in_words(estimate: Estimate, *, si: bool = False, sought: bool = True) -> str:
    """Return an estimate with its interval: ``5 mN/m (4.8 to 5.2)``, or ``< 3.8 µN/m``.

    An open interval that was not ``sought`` is left out.
    """
    unit_scale = scale(estimate, si=si)
    value = unit_scale.text(estimate.value)
    if not sought and estimate.low is None and estimate.high is None:
        return value
    if estimate.held:
        return f"fixed at {value}"
    if estimate.low is None and estimate.high is None:
        return "that this measurement does not determine"
    text = interval(estimate, si=si)
    is_open = None in (estimate.low, estimate.high)
    return unit_scale.with_unit(text) if is_open else f"{value} ({text})"
