"""Tables of fits: for the terminal, pages and notebooks alike."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pellicle.components import Column, Table
from pellicle.units import DIGITS, Scale
from pellicle_fit.estimation.candidate import Candidate
from pellicle_fit.estimation.coordinates import CONTACT_POINT, MODULUS
from pellicle_fit.estimation.intervals import CONFIDENCE, End, Estimate
from pellicle_fit.estimation.search import Ending
from pellicle_fit.population.fits import QUARTILES, summary
from pellicle_fit.population.row import FITTED, OVER_TIED, SHOWN, Row
from pellicle_fit.result import Fit
from pellicle_fit.selection.recipe import TENSION, Answer
from pellicle_fit.words.names import FEW, interval, quoted, unit_of, unit_of_one, words, words_of

_OPEN = {End.LIMIT, End.RANGE, End.STEPS, End.LACKING}
"""What an end is that needs a reason."""
_CORRELATED = 0.3
"""Least size of a correlation that tables show."""
_SI_DIGITS = 6
"""Significant digits of numbers in SI."""


def estimates(fit: Fit, *, si: bool = False) -> Table:
    """Return a row for each quantity of a fit, of several curves those that they share."""
    several, rows = len(fit.members) > 1, []
    slots = fit.answer.selected.objective.slots
    of_one = {slot.full_name for slot in slots if slot.curve is not None}
    for name, estimate in fit.estimates().items():
        if not (several and name in of_one) and (estimate.value or not estimate.held):
            unit = _unit(fit, name, si)
            value = "" if np.isnan(estimate.value) else unit.number(estimate.value)
            why = " and ".join(dict.fromkeys(e.value for e in estimate.ends if e in _OPEN))
            rows.append((words(name), value, interval(estimate, unit), unit.unit, why))
    caption = (
        f"The quantities of the model that was chosen, {words_of(fit.answer.selected)}; intervals "
        "of modulus and tension are over all models that describe the data as well."
    )
    heads = "parameter", "value", f"{100 * CONFIDENCE:.0f} % interval", "unit", "open end"
    count = len(heads) - (not any(why for *_, why in rows))
    return Table.of_rows(heads[:count], [row[:count] for row in rows], caption)


def correlations(fit: Fit) -> Table:
    """Return a row for each pair of correlated quantities of a fit, the strongest first."""
    several = len(fit.members) > 1
    slots = fit.answer.selected.objective.slots
    own = {slot.full_name for slot in slots if slot.curve is not None} if several else set()
    pairs = {
        pair: value
        for pair, value in fit.answer.selected.correlations.items()
        if not own.intersection(pair) and abs(value) >= _CORRELATED
    }
    ranked = sorted(pairs, key=lambda pair: -abs(pairs[pair]))
    columns = [
        Column("parameter", [words(one) for one, _ in ranked]),
        Column("and", [words(other) for _, other in ranked]),
        Column("correlation", [f"{pairs[pair]:.3f}" for pair in ranked]),
    ]
    caption = (
        f"Correlations of at least {_CORRELATED:g}; ± 1 where one quantity makes up for the other."
    )
    return Table(columns, caption, folded=True)


def explanations(fit: Fit, *, si: bool = False) -> Table:
    """Return a row for each explanation of the data that was compared, best first."""
    answer, compared = fit.answer, fit.answer.explanations
    columns = [
        Column("explanation", [words_of(one) for one in compared]),
        Column("χ²", [answer.chi_squared(one) for one in compared], digits=5),
        Column("ΔAIC", [one.aic - compared[0].aic for one in compared], digits=3),
        Column("tied", [_standing(answer, one) for one in compared]),
    ]
    for name in (MODULUS, TENSION):
        values = [one.parameters.get(name) for one in compared]
        # Not of all explanations intervals are sought.
        sought = [name in one.estimates for one in compared]
        columns += _quantity(name, _unit(fit, name, si), values, sought=sought)
    tie = f"below ΔAIC = {answer.decision.margin:.3g} it is a tie"
    return Table(columns, f"What describes the data, best first; {tie}.", folded=True)


def _standing(answer: Answer, one: Candidate) -> str:
    ending = one.minimum.ending
    if one in answer.tied or ending is Ending.CONVERGED:
        return "yes" if one in answer.tied else ""
    return "given up" if ending is Ending.GIVEN_UP else "not converged"


def curves(fit: Fit, *, si: bool = False) -> Table:
    """Return a row for each curve of a fit."""
    members, judgements, own = fit.members, fit.answer.judgements, fit.estimates()
    radii = [getattr(member.curve.indenter, "radius", "") for member in members]
    # That of the first has no number, one that is fixed has none at all.
    found = (own.get(f"{CONTACT_POINT}_{i}", own[CONTACT_POINT]) for i in range(len(members)))
    unit = _unit(fit, CONTACT_POINT, si)
    points = [f"{unit.number(e.value)} ({interval(e, unit)})" for e in found]
    checks = [", ".join(checked.failed_checks) for checked in judgements]
    columns = [
        Column("curve", [member.name for member in members]),
        *([Column("radius", radii, "m")] if any(radii) else []),
        Column(f"contact point [{unit.unit}]", points),
        Column("points", [member.curve.position.size for member in members]),
        Column("noise", [checked.deviation for checked in judgements], "N", digits=3),
        Column("failed checks", checks),
    ]
    caption = "The curves, each with its own contact point and noise."
    return Table(columns, caption, folded=True)


def rows(of: Sequence[Row], *, si: bool = False) -> Table:
    """Return a row for each curve of a population; a column only if it tells curves apart."""
    states = [
        f"rejected: {row.reason}"
        if row.is_fitted and not row.accepted
        else "modulus stands out" * row.outlier or (FITTED if row.is_fitted else "failed")
        for row in of
    ]
    radii = [row.curve.get("indenter", {}).get("radius", "") for row in of]
    has_youngs = any("youngs_modulus" in row.estimates for row in of)
    columns = list[Column]()
    for name in ("youngs_modulus", *[*SHOWN][1:]) if has_youngs else SHOWN:
        all_of = [row.estimates.get(name) for row in of]
        if name in OVER_TIED or 2 * sum(map(bool, all_of)) >= len(of):
            columns += _quantity(name, _usual(of, name, si), all_of, _SI_DIGITS if si else FEW)
    others = [
        Column("group", [row.group for row in of]),
        Column("radius", radii, "m"),
        Column("status", states, bad=[state != FITTED for state in states]),
    ]
    fitted = [n for n, row in enumerate(of) if row.is_fitted]
    columns += [c for c in others if any(c.bad) or len({str(c.values[n]) for n in fitted}) > 1]
    first = [Column("curve", [row.name for row in of]), Column("verdict", [r.verdict for r in of])]
    return Table([*first, *columns], "Each curve on its own, with its 95 % intervals.")


def groups(of: Sequence[Row], *, si: bool = False) -> Table:
    """Return a row for each parameter of each group of curves."""
    parts, cells = summary(of), []
    heads = ["group", "parameter", "accepted", "open", "outliers", "median", "quartiles"]
    if has_error := any("common_error" in part for part in parts):
        heads.append("common error")
    for part in parts:
        unit = _usual(of, part["parameter"], si)
        low, median, high = (unit.number(part[name]) for name in QUARTILES[1:4])
        counts = f"{part['n']} of {part['curves']}", str(part["open"]), str(part["outliers"])
        named = part["group"], f"{words(part['parameter'])} [{unit.unit}]"
        error = f"± {unit.number(e, FEW)}" if (e := part.get("common_error")) else ""
        ends = median, f"{low} to {high}"
        if part["no_sign"] == part["n"]:
            ends = "no sign", ""
        cells.append((*named, *counts, *ends, *([error] if has_error else [])))
    return Table.of_rows(
        heads, cells, "All accepted curves; open, those whose interval is open or wide."
    )


def _unit(fit: Fit, name: str, si: bool) -> Scale:
    """Return the unit of a quantity in all tables of a fit: its own or, if it is 0, of rivals."""
    own = fit.estimates()[name]
    if own.value or own.high:
        return unit_of_one(own, si=si)
    others = (one.parameters.get(name) for one in fit.answer.explanations)
    return unit_of([e.value for e in others if e is not None], own.unit, si=si)


def _usual(of: Sequence[Row], name: str, si: bool) -> Scale:
    """Return the unit of a quantity in all tables of curves: that of the median upper end."""
    found = [e for row in of if (e := row.estimates.get(name)) is not None]
    values = [size for e in found if (size := e.high or np.nan_to_num(e.value))] or [0.0]
    return unit_of([float(np.median(values))], found[0].unit if found else "", si=si)


def _quantity(
    name: str,
    unit: Scale,
    of: Sequence[Estimate | None],
    digits: int = DIGITS,
    sought: Sequence[bool] = (),
) -> list[Column]:
    """Return the column of a quantity, with intervals that were ``sought``; none if all lack it."""
    of = [None if e is None or (e.held and not e.value) else e for e in of]
    texts = [
        (quoted(e, unit, digits) if wanted else unit.number(e.value, digits)) if e else ""
        for e, wanted in zip(of, sought or [True] * len(of), strict=True)
    ]
    head = f"{words(name)} [{unit.unit}]"
    return [Column(head, texts, meaning="with its 95 % interval")] if any(of) else []
