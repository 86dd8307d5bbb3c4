"""How a result was computed, as a paragraph for the methods section of a paper."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

from pellicle.components import Prescription
from pellicle.components.installed import registry
from pellicle.components.prescription import OPTIONS
from pellicle.config.describe import FieldRow, inputs
from pellicle.config.run import Run
from pellicle.units import DIGITS, axis_unit, readable
from pellicle.variables import words_of_name
from pellicle.version import CITATION

_FEW = 5
"""Number of load steps up to which their values are listed."""


def methods(
    configuration: Mapping[str, Any], attributes: Mapping[str, Any], varied: tuple[str, ...] = ()
) -> str:
    """Return a paragraph for the methods section of a paper.

    ``attributes`` are those of the result, or of the table of the study. Values at the dotted paths
    ``varied`` differ between the runs of a study.
    """
    known = {i.name: i for i in inputs(configuration, Run)}
    grid, on_cells = configuration["grid"], ""
    if not any(axis.startswith("grid") for axis in varied):
        points = " × ".join(str(n) for n in grid["points"])
        size = " × ".join(readable(edge, "m", DIGITS) for edge in grid["size"])
        on_cells = f" on {points} cells of {size}"
    described = []
    for name in ("kernel", "load", "indenter", "interaction"):
        if name not in known or f"{name}.type" in varied:
            continue
        values = ", ".join(
            f"{i.words} {i.value}"
            for i in known.values()
            if i.name.startswith(f"{name}.")
            and not any(f"{i.name}.".startswith(f"{axis}.") for axis in varied)
        )
        described.append(f"{name}: {known[name].value}{f' ({values})' if values else ''}")
    parts = "; ".join(described)
    words = [known[name].words if name in known else name for name in varied]
    changes = f"Varied: {', '.join(words)}. " if words else ""
    is_one = "solver" in known and "solver.type" not in varied
    solver = known["solver"].value if is_one else "several solvers"
    loading, solved = "", ""
    of_what = "Deformation of a linear solid under a known traction"
    if "load" not in configuration:
        solved = f"Solver: {solver}, to a relative tolerance of {attributes['tolerance']:g}. "
        loading = _loading(configuration["loading"], attributes, known, varied)
        of_what = "Normal contact of a rigid indenter with a linear solid"
    elif times := configuration.get("loading", {}).get("time"):
        loading = f"Times: {_values_of_steps(times, 's', f'{len(times)} steps')}. "
    return (
        f"{of_what} was solved by a boundary element "
        f"method with fast Fourier transforms{on_cells} with {grid['boundary']} boundaries. "
        f"{parts[:1].upper()}{parts[1:]}. {loading}{changes}"
        f"{solved}Computed with {attributes['versions']}. To cite: {CITATION}."
    )


def _loading(
    loading: Mapping[str, Any],
    attributes: Mapping[str, Any],
    known: Mapping[str, FieldRow],
    varied: tuple[str, ...],
) -> str:
    name = attributes["prescribed"]
    texts = [words_of_name(name)]
    if not any(axis.startswith(f"loading.{name}") for axis in varied):
        prescription = cast(type[Prescription], registry().find("prescription", name))
        count = f"{attributes['planned_steps']} load steps"
        texts[0] += f" {_values_of_steps(loading[name], prescription.unit, count)}"
    for key in loading:
        path = f"loading.{key}"
        if key not in (*OPTIONS, name) and path in known and path not in varied:
            texts.append(f"{known[path].words} {known[path].value}")
    return f"Prescribed: {', '.join(texts)}. "


def _values_of_steps(values: Sequence[Any], unit: str, count: str) -> str:
    """Return the values of load steps as words, such as "from 1 to 5 nN in 12 load steps"."""
    if any(isinstance(value, Mapping) for value in values):
        return f"in {len(values)} legs of {count} in all"
    if len(values) <= _FEW:
        return readable(values, unit, DIGITS)
    scale = axis_unit(values, unit)
    first, last = values[0], values[-1]
    furthest = max(values, key=lambda value: abs(value - first))
    ends = f"from {scale.number(first)} to {scale.text(furthest if last == first else last)}"
    return f"{ends}{' and back' * (last == first)} in {count}"
