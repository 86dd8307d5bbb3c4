"""Tables of fits: for the terminal, pages and notebooks alike."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pellicle.components import Column, Table
from pellicle.units import Scale
from pellicle_fit.intervals import CONFIDENCE, Estimate
from pellicle_fit.objective import CONTACT_POINT, MODULUS
from pellicle_fit.population.row import FITTED, Row
from pellicle_fit.population.summary import QUARTILES, summary
from pellicle_fit.recipe import TENSION
from pellicle_fit.result import Fit, name_of, parameters_of
from pellicle_fit.verdict import MARGIN
from pellicle_fit.words.effects import words as words_of
from pellicle_fit.words.quantities import SHOWN, interval, unit_of, unit_of_estimate, words
from pellicle_fit.words.remarks import failed_checks

_MEANING = "values that describe the data nearly as well"


def estimates(fit: Fit, *, si: bool = False) -> Table:
    """Return a row for each quantity of a fit, of several curves those that they share."""
    several, rows = len(fit.members) > 1, []
    slots = fit.answer.chosen.objective.slots
    of_one = {name_of(slot.name, slot.curve) for slot in slots if slot.curve is not None}
    for name, estimate in fit.estimates().items():
        if not (several and name in of_one):
            unit = _unit(fit, name, si)
            ends = interval(estimate, unit)
            rows.append((words(name), unit.number(estimate.value), ends, unit.unit))
    caption = (
        f"The quantities of the model that was chosen, {words_of(fit.answer.chosen)}; intervals of "
        "modulus and tension are over all models that describe the data as well."
    )
    heads = "parameter", "value", f"{100 * CONFIDENCE:.0f} % interval", "unit"
    return Table.of_rows(heads, rows, caption)


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
        of = [parameters_of(one).get(name) for one in compared]
        columns += _quantity(name, of, _unit(fit, name, si), sought)
    tie = f"below ΔAIC = {max(MARGIN, answer.threshold):.3g} it is a tie"
    return Table(columns, f"What describes the data, best first; {tie}.", folded=True)


def curves(fit: Fit, *, si: bool = False) -> Table:
    """Return a row for each curve of a fit."""
    members, judgements, own = fit.members, fit.answer.judgements, fit.estimates()
    radii = [getattr(member.curve.indenter, "radius", "") for member in members]
    points = [own[name_of(CONTACT_POINT, number)] for number in range(len(members))]
    checks = [", ".join(failed_checks(judged)) for judged in judgements]
    columns = [
        Column("curve", [member.name for member in members]),
        *([Column("radius", radii, "m")] if any(radii) else []),
        *_quantity(CONTACT_POINT, points, _unit(fit, CONTACT_POINT, si)),
        Column("points", [member.curve.position.size for member in members]),
        Column("noise", [judged.noise.deviation for judged in judgements], "N", digits=3),
        Column("failed checks", checks),
    ]
    caption = "The curves, each with its own contact point and noise."
    return Table(columns, caption, folded=True)


def rows(of: Sequence[Row], *, si: bool = False) -> Table:
    """Return a row for each curve of a population; a column only if it tells curves apart."""
    states = []
    for row in of:
        if row.is_fitted and not row.accepted:
            # A verdict against all models stands in its own column.
            reason = row.reason if row.reason != row.fit["comparison"] else ""
            states.append(f"rejected: {reason}".removesuffix(": "))
        else:
            states.append("modulus stands out" * row.outlier or row.status.partition(":")[0])
    radii = [row.curve.get("indenter", {}).get("radius", "") for row in of]
    columns = [Column("verdict", [row.verdict for row in of])]
    for name in SHOWN:
        columns += _quantity(name, [row.estimates.get(name) for row in of], _usual(of, name, si))
    columns += [
        Column("group", [row.group for row in of]),
        # It is not known of curves that could not be fitted.
        Column("radius", radii if len({*radii} - {""}) > 1 else [""] * len(of), "m"),
        Column("R²", [row.numbers.get("r_squared", "") for row in of], digits=5),
        Column("failed checks", [", ".join(row.failed_checks) for row in of]),
        Column("status", states, bad=[state != FITTED for state in states]),
    ]
    shown = [one for one in columns if len(of) == 1 or len({*map(str, one.values)}) > 1]
    first = Column("curve", [row.name for row in of])
    return Table([first, *shown], "Each curve on its own, with its 95 % intervals.")


def groups(of: Sequence[Row], *, si: bool = False) -> Table:
    """Return a row for each parameter of each group of curves."""
    cells = []
    for part in summary(of):
        unit = _usual(of, part["parameter"], si)
        low, median, high = (unit.number(part[name]) for name in QUARTILES[1:4])
        counts = f"{part['n']} of {part['curves']}", str(part["open"]), str(part["outliers"])
        named = part["group"], f"{words(part['parameter'])} [{unit.unit}]"
        cells.append((*named, *counts, median, f"{low} to {high}"))
    heads = "group", "parameter", "accepted", "open", "outliers", "median", "quartiles"
    return Table.of_rows(heads, cells, "The accepted curves.")


def _unit(fit: Fit, name: str, si: bool) -> Scale:
    """Return the unit of a quantity in all tables of a fit: its own or, if it is 0, of rivals."""
    own = fit.estimates()[name]
    if own.value or own.high:
        return unit_of_estimate(own, si=si)
    others = (parameters_of(one).get(name) for one in fit.answer.explanations)
    return unit_of([e.value for e in others if e is not None], own.unit, si=si)


def _usual(of: Sequence[Row], name: str, si: bool) -> Scale:
    """Return the unit of a quantity in all tables of curves: that of the median."""
    known = [e for row in of if (e := row.estimates.get(name)) is not None]
    values = [e.value for e in known if e.value] or [0.0]
    return unit_of([float(np.median(values))], known[0].unit if known else "", si=si)


def _quantity(
    name: str, of: Sequence[Estimate | None], unit: Scale, sought: Sequence[bool] = ()
) -> list[Column]:
    """Return the columns of values and intervals of a quantity; none if no curve has it.

    Intervals are those that were ``sought``, by default all; of an open one the end that it has.
    """
    if not any(e is not None and not (e.held and not e.value) for e in of):
        return []
    values, ends = ["" if e is None else e.value for e in of], []
    for estimate, wanted in zip(of, sought or [True] * len(of), strict=True):
        ends.append(interval(estimate, unit) if estimate is not None and wanted else "")
    in_si = next(e.unit for e in of if e is not None)
    return [
        Column(words(name), values, in_si, read_in=unit),
        Column(f"95 % of {words(name)}", ends, meaning=_MEANING),
    ]
