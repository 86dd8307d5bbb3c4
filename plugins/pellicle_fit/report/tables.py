"""Tables of fits: for the terminal, pages and notebooks alike."""

from __future__ import annotations

from collections.abc import Sequence

from pellicle.components import Column, Table
from pellicle.units import DIGITS
from pellicle_fit.intervals import CONFIDENCE, Estimate
from pellicle_fit.objective import CONTACT_POINT, MODULUS
from pellicle_fit.population.row import FITTED, Row
from pellicle_fit.population.summary import QUARTILES, summary
from pellicle_fit.recipe import TENSION
from pellicle_fit.result import Fit, name_of, parameters_of
from pellicle_fit.verdict import MARGIN
from pellicle_fit.words.effects import words as words_of
from pellicle_fit.words.quantities import (
    FEW,
    OVER_TIED,
    SHOWN,
    interval,
    known,
    unit_of,
    unit_of_estimate,
    words,
)
from pellicle_fit.words.remarks import failed_checks

_INTERVAL = f"{100 * CONFIDENCE:.0f} % interval"
_EACH = "Each curve on its own, with its 95 % intervals."
_MEANING = "values that describe the data nearly as well"


def estimates(fit: Fit, *, si: bool = False) -> Table:
    """Return a row for each quantity of a fit, of several curves those that they share."""
    several, rows = len(fit.members) > 1, []
    slots = fit.answer.chosen.objective.slots
    of_one = {name_of(slot.name, slot.curve) for slot in slots if slot.curve is not None}
    for name, estimate in fit.estimates().items():
        if not (several and name in of_one):
            unit = unit_of_estimate(estimate, si=si)
            ends = interval(estimate, unit)
            rows.append((words(name), unit.number(estimate.value), ends, unit.unit))
    caption = (
        f"The quantities of the model that was chosen, {words_of(fit.answer.chosen)}; intervals of "
        "modulus and tension are over all models that describe the data as well."
    )
    return Table.of_rows(("parameter", "value", _INTERVAL, "unit"), rows, caption)


def explanations(fit: Fit, *, si: bool = False) -> Table:
    """Return a row for each explanation of the data that was compared, best first."""
    answer, compared = fit.answer, fit.answer.explanations
    tied = {other.types for other in answer.tied}
    columns = [
        Column("explanation", [words_of(one) for one in compared]),
        Column("χ²", [one.chi_squared for one in compared], digits=5),
        Column("ΔAIC", [one.aic - compared[0].aic for one in compared], digits=3),
        Column("tied", ["yes" if one.types in tied else "" for one in compared]),
    ]
    for name in (MODULUS, TENSION):
        # Not of all explanations intervals are sought.
        sought = [name in one.estimates for one in compared]
        columns += _quantity(name, [parameters_of(one).get(name) for one in compared], si, sought)
    margin = max(MARGIN, answer.threshold)
    caption = f"What describes the data, best first; below ΔAIC = {margin:.3g} it is a tie."
    return Table(columns, caption)


def curves(fit: Fit, *, si: bool = False) -> Table:
    """Return a row for each curve of a fit."""
    members, judgements, own = fit.members, fit.answer.judgements, fit.estimates()
    radii = [getattr(member.curve.indenter, "radius", "") for member in members]
    points = [own[name_of(CONTACT_POINT, number)] for number in range(len(members))]
    checks = [", ".join(failed_checks(judged)) for judged in judgements]
    columns = [
        Column("curve", [member.name for member in members]),
        *([Column("radius", radii, "m")] if any(radii) else []),
        *_quantity(CONTACT_POINT, points, si),
        Column("points", [member.curve.position.size for member in members]),
        Column("noise", [judged.noise.deviation for judged in judgements], "N", digits=3),
        Column("failed checks", checks),
    ]
    return Table(columns, "The curves, each with its own contact point and noise.")


def rows(of: Sequence[Row], *, si: bool = False) -> Table:
    """Return a row for each curve of a population; a column only if it tells curves apart."""
    states, reasons = [], []
    for row in of:
        rejected = row.is_fitted and not row.accepted
        state = "stands out" if row.outlier else row.status.partition(":")[0]
        states.append("rejected" if rejected else state)
        reasons.append(row.reason if rejected and row.reason != row.fit["comparison"] else "")
    radii = [row.curve.get("indenter", {}).get("radius", "") for row in of]
    columns = list[Column]()
    for name in SHOWN:
        values = [row.estimates.get(name) for row in of]
        if name in OVER_TIED or 2 * sum(map(bool, values)) >= len(of):
            columns += _quantity(name, values, si, digits=FEW)
    columns += [
        Column("group", [row.group for row in of]),
        Column("radius", radii, "m"),
        Column("status", states, bad=[state != FITTED for state in states]),
        Column("reason", reasons, bad=[reason != "" for reason in reasons]),
    ]
    fitted = [number for number, row in enumerate(of) if row.is_fitted]
    told = [
        one
        for one in columns
        if len({str(one.values[number]) for number in fitted}) > 1 or any(one.bad)
    ]
    first = [Column("curve", [row.name for row in of]), Column("verdict", [r.verdict for r in of])]
    return Table([*first, *(told if len(of) > 1 else columns)], _EACH)


def groups(of: Sequence[Row], *, si: bool = False) -> Table:
    """Return a row for each parameter of each group of curves."""
    parts, cells = summary(of), []
    for part in parts:
        # The groups of one parameter share their unit.
        parameter = part["parameter"]
        medians = [other["median"] for other in parts if other["parameter"] == parameter]
        unit = unit_of(medians, part["unit"], si=si)
        low, median, high = (unit.number(part[name]) for name in QUARTILES[1:4])
        counts = f"{part['n']} of {part['curves']}", str(part["open"]), str(part["outliers"])
        name = f"{words(parameter)} [{unit.unit}]"
        cells.append((part["group"], name, *counts, median, f"{low} to {high}"))
    heads = "group", "parameter", "accepted", "open", "outliers", "median", "quartiles"
    return Table.of_rows(heads, cells, "The accepted curves.")


def _quantity(
    name: str,
    of: Sequence[Estimate | None],
    si: bool,
    sought: Sequence[bool] = (),
    digits: int = DIGITS,
) -> list[Column]:
    """Return the columns of values and intervals of a quantity; none if no curve has it.

    Intervals are those that were ``sought``, by default all; of an open one the end that it has.
    What is 0 because an explanation has none is left out, and in few digits what is not `known`.
    """
    of = [None if e is not None and e.held and not e.value else e for e in of]
    if not any(of):
        return []
    unit = next(e.unit for e in of if e is not None)
    few = digits < DIGITS
    numbers = [e.value if e is not None and (known(e) or not few) else "" for e in of]
    values = Column(words(name), numbers, unit, digits=digits)
    scale, ends = values.unit_and_digits(si=si)[0], []
    for estimate, wanted in zip(of, sought or [True] * len(of), strict=True):
        ends.append(interval(estimate, scale, digits) if estimate is not None and wanted else "")
    return [values, Column(f"95 % of {words(name)}", ends, meaning=_MEANING)]
