"""The quantities of a run that the explorer changes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pellicle.config.run import Run
from pellicle.config.wording import field_words
from pellicle.model.paths import walk
from pellicle.units import Quantity, axis_unit, quantity_of

_TABLES = ("kernel", "indenter", "interaction")
_DIGITS = 4
"""Significant digits of a value that a slider sets."""


@dataclass(frozen=True)
class Control:
    """A quantity of a run: a component's field, or the last of the load steps."""

    path: str
    """Dotted path in the run file, as for ``--set``."""
    label: str
    quantity: Quantity
    value: float
    """Present value in SI."""

    @property
    def low(self) -> float:
        """The lowest value of the slider."""
        if self.is_logarithmic:
            return self.value / 10
        return min(0.0, self.value)

    @property
    def high(self) -> float:
        """The highest value of the slider."""
        if self.is_logarithmic:
            return self.value * 10
        return min(b for b in (self.quantity.at_most, self.quantity.below) if b is not None)

    @property
    def is_logarithmic(self) -> bool:
        """Whether the slider moves over decades; else from 0 to the highest allowed value."""
        return self.quantity.unit not in ("1", "rad")

    def text(self, value: float) -> str:
        """Return a value in the unit of the present one, as a run file has it."""
        if self.quantity.unit == "1":
            return f"{round(value, _DIGITS):g}"
        factor, unit = axis_unit([self.value], self.quantity.unit)
        return f"{value * factor:.{_DIGITS}g} {unit}"


def controls(run: Run) -> list[Control]:
    """Return a control for each positive quantity of solid, indenter and interaction, and the load.

    Quantities that are 0 have none: nothing says how large they might become.
    """
    return [*_fields(run), *_load(run)]


def _fields(run: Run) -> Iterator[Control]:
    for path, value, field in walk(run):
        quantity = quantity_of(field) if field else None
        if path.partition(".")[0] not in _TABLES or quantity is None:
            continue
        if isinstance(value, float) and value > 0 and _has_range(quantity):
            name = path.rpartition(".")[2]
            yield Control(path, field_words(name, field), quantity, value)


def _has_range(quantity: Quantity) -> bool:
    bounded = quantity.at_most is not None or quantity.below is not None
    return bounded or quantity.unit not in ("1", "rad")


def _load(run: Run) -> Iterator[Control]:
    loading = run.loading
    quantity = loading.prescription.quantity()
    last = max(loading.values, key=abs)
    if last > 0 and not loading.samples:
        label = f"largest {loading.prescribed.replace('_', ' ')}"
        yield Control(f"loading.{loading.prescribed}", label, quantity, last)
