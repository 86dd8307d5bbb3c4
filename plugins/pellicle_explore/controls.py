"""The quantities of a run that the explorer changes.

Configurations are mappings of the form of a run file, with the load steps as a list.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import pellicle as pl
from pellicle.schema import replace_at, walk
from pellicle.units import Quantity, quantity_of


class Control(NamedTuple):
    """A quantity of a run: a component's field, or the largest of the load steps."""

    path: str
    """Dotted path in the run file, as for ``--set``."""
    label: str
    quantity: Quantity
    value: float
    """Present value in SI, above 0."""
    highest: float | None
    """End of the slider, which begins at 0; None if it moves over two decades."""

    def position(self, value: float) -> float:
        """Return the position of the slider for a value, or that of its end on that side."""
        if self.highest is not None:
            return min(max(value, 0.0), self.highest)
        return math.log10(min(max(value, self.value / 10), self.value * 10))

    def value_at(self, position: float) -> float:
        """Return the value for a position of the slider."""
        return 10**position if self.highest is None else position


def controls(run: pl.Run) -> Iterator[Control]:
    """Yield a control for each positive quantity of solid, indenter and interaction, and the load.

    Quantities that are 0 have none: nothing says how large they might become.
    """
    for path, value, field in walk(run):
        quantity = quantity_of(field) if field else None
        table, _, name = path.partition(".")
        if table not in ("kernel", "indenter", "interaction") or not field or not quantity:
            continue
        bounds = [b for b in (quantity.at_most, quantity.below) if b is not None]
        has_scale = quantity.unit not in ("1", "rad")
        if isinstance(value, float) and value > 0 and (has_scale or bounds):
            label = field.title or name.rpartition(".")[2].replace("_", " ")
            yield Control(path, label, quantity, value, None if has_scale else min(bounds))
    load = run.indentation.loading
    largest = max(load.values, key=abs)
    if largest > 0 and not load.samples:
        label = f"largest {load.prescribed.replace('_', ' ')}"
        quantity = load.prescription.quantity()
        yield Control(f"loading.{load.prescribed}", label, quantity, largest, None)


def configuration_of(run: pl.Run) -> dict[str, Any]:
    """Return the configuration of a run, in SI."""
    data: dict[str, Any] = run.model_dump(mode="json", exclude_unset=True, exclude_none=True)
    loading = run.indentation.loading
    if loading.samples:
        return data
    return dict(replace_at(data, f"loading.{loading.prescribed}", list(loading.values)))


def change_control(
    configuration: Mapping[str, Any], control: Control, text: str
) -> tuple[dict[str, Any], float]:
    """Return a configuration with a new value of a control, given as text, and the value in SI.

    All load steps change in proportion to their largest. A ValueError says why the text is refused.
    """
    try:
        value: Any = float(text)
    except ValueError:
        value = text
    number = control.quantity(value)
    table, _, key = control.path.partition(".")
    if table == "loading":
        if number <= 0:
            raise ValueError(
                f"{text!r} is not above 0; the load steps keep their proportion to the largest"
            )
        steps = configuration["loading"][key]
        value = [step * number / max(map(abs, steps)) for step in steps]
    data = dict(replace_at(configuration, control.path, value))
    pl.Run.from_mapping(data)
    return data, number
