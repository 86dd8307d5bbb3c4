"""Tables of fits: for the terminal, pages and notebooks alike."""

from __future__ import annotations

from collections.abc import Sequence

from pellicle.components import Column, Table
from pellicle.units import Scale
from pellicle_fit.intervals import CONFIDENCE, Estimate
from pellicle_fit.objective import MODULUS
from pellicle_fit.population.row import FITTED, Row
from pellicle_fit.population.summary import summary
from pellicle_fit.recipe import TENSION
from pellicle_fit.result import Fit, name_of, parameters_of
from pellicle_fit.sentences import failed_checks
from pellicle_fit.sentences import words as words_of
from pellicle_fit.verdict import MARGIN
from pellicle_fit.wording import column_scale, interval, interval_text, scale, words

_INTERVAL = f"{100 * CONFIDENCE:.0f} % interval"
_MEANING = "values that describe the data nearly as well"
_SHOWN = MODULUS, TENSION, "work_of_adhesion", "thickness"
"""Quantities whose intervals a table of many curves has, if one of them has it."""


def estimates(fit: Fit, *, si: bool = False) -> Table:
    """Return a row for each quantity of a fit, of several curves those that they share."""
    several, rows = len(fit.members) > 1, []
    slots = fit.answer.chosen.objective.slots
    of_one = {name_of(slot.name, slot.curve) for slot in slots if slot.curve is not None}
    for name, estimate in fit.estimates().items():
        if several and name in of_one:
            continue
        unit = scale(estimate, si=si)
        ends = interval(estimate, si=si)
        rows.append((words(name), unit.number(estimate.value), ends, unit.unit))
    caption = (
        "Intervals of modulus and tension are over all explanations that the data cannot tell "
        f"apart, the others those of the one that is chosen: {words_of(fit.answer.chosen)}."
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
        values = [parameters_of(one).get(name) for one in compared]
        # Of the others no interval is sought.
        sought = [
            v if name in one.estimates else None for v, one in zip(values, compared, strict=True)
        ]
        columns += _quantity(name, values, si, sought)
    margin = max(MARGIN, answer.threshold)
    caption = f"What describes the data, best first; below ΔAIC = {margin:.3g} it is a tie."
    return Table(columns, caption)


def curves(fit: Fit, *, si: bool = False) -> Table:
    """Return a row for each curve of a fit."""
    members, judgements, own = fit.members, fit.answer.judgements, fit.estimates()
    radii = [getattr(member.curve.indenter, "radius", "") for member in members]
    points = [own[name_of("contact_point", number)] for number in range(len(members))]
    checks = [", ".join(code for code, _ in failed_checks(judged)) for judged in judgements]
    columns = [
        Column("curve", [member.name for member in members]),
        *([Column("radius", radii, "m")] if any(radii) else []),
        *_quantity("contact_point", points, si),
        Column("points", [member.curve.position.size for member in members]),
        Column("noise", [judged.noise.deviation for judged in judgements], "N", digits=3),
        Column("failed checks", checks),
    ]
    return Table(columns, "The curves, each with its own contact point and noise.")


def rows(of: Sequence[Row], *, si: bool = False) -> Table:
    """Return a row for each curve of a population."""
    columns, radii = [Column("curve", [row.name for row in of])], [row.radius for row in of]
    if any(row.group for row in of):
        columns.append(Column("group", [row.group for row in of]))
    if len({radius for radius in radii if radius != ""}) > 1:
        columns.append(Column("radius", radii, "m"))
    columns.append(Column("model", [row.model for row in of]))
    for name in _SHOWN:
        columns += _quantity(name, [row.estimates.get(name) for row in of], si)
    columns += _quantity("contact_point", [row.estimates.get("contact_point") for row in of], si)[
        :1
    ]
    columns.append(Column("verdict", [row.verdict for row in of]))
    columns.append(Column("R²", [row.numbers.get("r_squared", "") for row in of], digits=5))
    columns.append(Column("failed checks", [", ".join(row.failed_checks) for row in of]))
    columns.append(Column("notes", [str(len(row.messages)) for row in of]))
    states = [row.status.partition(":")[0] for row in of]
    rejected = [row.is_fitted and not row.accepted for row in of]
    states = ["rejected" if bad else state for state, bad in zip(states, rejected, strict=True)]
    columns.append(Column("status", states, bad=[state != FITTED for state in states]))
    if any(rejected):
        reasons = [row.reason if bad else "" for row, bad in zip(of, rejected, strict=True)]
        columns.append(Column("reason", reasons, bad=rejected))
    if any(outliers := [row.outlier for row in of]):
        marks = ["stands out" if outlier else "" for outlier in outliers]
        columns.append(Column("modulus", marks, bad=outliers))
    return Table(columns, "Each curve on its own, with its 95 % intervals.")


def groups(of: Sequence[Row], *, si: bool = False) -> Table:
    """Return a row for each parameter of each group of curves."""
    parts, cells = summary(of), []
    for part in parts:
        # The groups of one parameter share their unit.
        medians = [other.median for other in parts if other.parameter == part.parameter]
        unit = column_scale(medians, part.unit, si=si)
        low, high = (unit.number(end) for end in (part.lower_quartile, part.upper_quartile))
        counts = f"{part.n} of {part.curves}", str(part.open), str(part.outliers)
        name = f"{words(part.parameter)} [{unit.unit}]"
        cells.append((part.group, name, *counts, unit.number(part.median), f"{low} to {high}"))
    heads = "group", "parameter", "accepted", "open", "outliers", "median", "quartiles"
    return Table.of_rows(heads, cells, "The accepted curves.")


def _quantity(
    name: str,
    estimates: Sequence[Estimate | None],
    si: bool,
    sought: Sequence[Estimate | None] | None = None,
) -> list[Column]:
    """Return the columns of values and intervals of a quantity; none if no curve has it.

    Intervals are those of the estimates that were ``sought``, by default all.
    """
    if not any(e is not None and not (e.held and not e.value) for e in estimates):
        return []
    unit = next(e.unit for e in estimates if e is not None)
    values = Column(words(name), ["" if e is None else e.value for e in estimates], unit)
    scale, _ = values.unit_and_digits(si=si)
    texts = ["" if e is None else _ends(e, scale) for e in sought or estimates]
    return [values, Column(f"95 % of {words(name)}", texts, meaning=_MEANING)]


def _ends(estimate: Estimate, scale: Scale) -> str:
    """Return an interval in the unit of a column."""
    return "fixed" if estimate.held else interval_text(estimate.low, estimate.high, scale)
