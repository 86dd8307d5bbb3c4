"""Tables of fits: for the terminal, pages and notebooks alike."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pellicle.components import Column, Table
from pellicle.units import DIGITS, Scale
from pellicle_fit.estimation.coordinates import CONTACT_POINT, MODULUS
from pellicle_fit.estimation.intervals import CONFIDENCE, End, Estimate
from pellicle_fit.population.fits import QUARTILES, summary
from pellicle_fit.population.row import FITTED, SHOWN, Row
from pellicle_fit.record import OVER_TIED, Record
from pellicle_fit.selection.recipe import TENSION
from pellicle_fit.words.names import FEW, interval, quote_estimate, scale_of, unit_of, words

_OPEN = {*End} - {End.CLOSED, End.NOT_SOUGHT}
"""What an end is that needs a reason."""
_CORRELATED = 0.3
"""Least size of a correlation that tables show."""
_MANY = 200
"""Most curves whose table a page shows before a click, as it stays quick."""
_SI_DIGITS = 6
"""Significant digits of numbers in SI."""
_SEARCHES = {"converged": "", "given_up": "given up"}
"""What is said of a search, by how it ended; of all others that they did not converge."""


def estimates(fit: Record, *, si: bool = False) -> Table:
    """Return a row for each quantity of a fit, of several curves those that they share."""
    known, of_one, rows = fit.estimates(), _of_one_curve(fit), []
    for name in dict.fromkeys((MODULUS, TENSION, *known)):
        estimate = known[name]
        if name not in of_one and (estimate.value or not estimate.held):
            unit = _unit(fit, name, si)
            value = "" if np.isnan(estimate.value) else unit.number(estimate.value)
            why = " and ".join(dict.fromkeys(e.value for e in estimate.ends if e in _OPEN))
            rows.append((words(name), value, interval(estimate, unit), unit.unit, why))
    caption = (
        f"The quantities of the model that was chosen, {fit.data['model']['words']}; intervals "
        "of modulus and tension are over all models that describe the data as well."
    )
    heads = "parameter", "value", f"{100 * CONFIDENCE:.0f} % interval", "unit", "open end"
    count = len(heads) - (not any(why for *_, why in rows))
    return Table.of_rows(heads[:count], [row[:count] for row in rows], caption)


def _of_one_curve(fit: Record) -> set[str]:
    """Return the quantities of which each of several curves has its own."""
    curves = fit.curves if len(fit.curves) > 1 else []
    return {name for curve in curves for name in curve["quantities"]}


def correlations(fit: Record) -> Table:
    """Return a row for each pair of correlated quantities of a fit, the strongest first."""
    own = _of_one_curve(fit)
    pairs = [
        (*map(words, of), value)
        for of, value in ((pair["of"], pair["value"]) for pair in fit.data["correlations"])
        if not own.intersection(of) and abs(value) >= _CORRELATED
    ]
    pairs.sort(key=lambda pair: -abs(pair[2]))
    caption = (
        f"Correlations of at least {_CORRELATED:g}; ± 1 where one quantity makes up for the other."
    )
    rows = [(*of, f"{value:.3f}") for *of, value in pairs]
    return Table.of_rows(("parameter", "and", "correlation"), rows, caption, folded=True)


def explanations(fit: Record, *, si: bool = False) -> Table:
    """Return a row for each explanation of the data that was compared, best first."""
    compared = fit.data["explanations"]
    searches = [_SEARCHES.get(one["search"], "not converged") for one in compared]
    columns = [
        Column("explanation", [one["words"] for one in compared]),
        Column("χ²", [one["chi_squared"] for one in compared], digits=5),
        Column("ΔAIC", [one["delta_aic"] for one in compared], digits=3),
        Column(
            "tied", ["yes" if o["tied"] else s for o, s in zip(compared, searches, strict=True)]
        ),
    ]
    for name in (MODULUS, TENSION):
        entries = [one["parameters"].get(name) for one in compared]
        values = [e and Estimate.of_dict({"low": None, "high": None} | e) for e in entries]
        # Not of all explanations intervals are sought.
        sought = [bool(e) and "low" in e and not e["held"] for e in entries]
        columns += _quantity(name, _unit(fit, name, si), values, sought=sought)
    tie = f"below ΔAIC = {fit.data['margin']:.3g} it is a tie"
    return Table(columns, f"What describes the data, best first; {tie}.", folded=True)


def sines(fit: Record, *, si: bool = False) -> Table:
    """Return a row for each sine of a fit; none if there are no sines."""
    of, ratio = fit.sines, fit.data["poissons_ratio"]
    factor, modulus = (1.0, "reduced") if ratio is None else (1 - ratio**2, "Young's")
    columns = [Column("frequency", [sine["frequency"].value for sine in of], "Hz", digits=FEW)]
    if len(fit.curves) > 1:
        names = [curve["name"] for curve in fit.curves for _ in curve["sines"]]
        columns.insert(0, Column("curve", names))
    for storage, loss, symbol in (("stiffness", "stiffness", "K"), ("modulus", "modulus", "E")):
        scale = factor if symbol == "E" else 1.0
        both = [
            [sine[f"{kind}_{name}"].times(scale) for sine in of]
            for kind, name in (("storage", storage), ("loss", loss))
        ]
        unit = unit_of([e.value for e in both[0]] or [0.0], both[0][0].unit if of else "", si=si)
        for prime, measured in zip("′″", both, strict=True):
            # Also of those that may be 0.
            texts = [f"{unit.number(e.value, FEW)} ({interval(e, unit, FEW)})" for e in measured]
            head = f"{symbol}{prime} [{unit.unit}]"
            columns.append(Column(head, texts, meaning="with its 95 % interval"))
    degrees = [np.rad2deg(sine["phase"].value) for sine in of]
    columns.append(Column("phase [°]", [f"{phase:.1f}" for phase in degrees]))
    caption = (
        f"Sines at a fixed contact: K′ and K″ as measured, E′ and E″ of the {modulus} modulus for "
        "the contact of the model that was chosen; with 95 % intervals."
    )
    return Table(columns if of else [], caption)


def curves(fit: Record, *, si: bool = False) -> Table:
    """Return a row for each curve of a fit."""
    of, own = fit.curves, fit.estimates()
    radii = [curve["indenter"].get("radius", "") for curve in of]
    # That of the first has no number, one that is fixed has none at all.
    found = (own.get(f"{CONTACT_POINT}_{i}", own[CONTACT_POINT]) for i in range(len(of)))
    unit = _unit(fit, CONTACT_POINT, si)
    points = [f"{unit.number(e.value)} ({interval(e, unit)})" for e in found]
    checks = [", ".join(check["code"] for check in curve["failed_checks"]) for curve in of]
    columns = [
        Column("curve", [curve["name"] for curve in of]),
        *([Column("radius", radii, "m")] if any(radii) else []),
        Column(f"contact point [{unit.unit}]", points),
        Column("points", [curve["points"] for curve in of]),
        Column("noise", [curve["noise"]["value"] for curve in of], "N", digits=3),
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
    # A row is unpacked once.
    known = [
        (fit.headline, fit.curve.get("indenter", {}).get("radius", ""), fit.estimates())
        for fit in (row.fit for row in of)
    ]
    verdicts, radii, found = zip(*known, strict=True) if known else ((), (), ())
    has_youngs = any("youngs_modulus" in one for one in found)
    columns = list[Column]()
    for name in ("youngs_modulus", *[*SHOWN][1:]) if has_youngs else SHOWN:
        all_of = [one.get(name) for one in found]
        if name in OVER_TIED or 2 * sum(map(bool, all_of)) >= len(of):
            columns += _quantity(name, _usual(all_of, si), all_of, _SI_DIGITS if si else FEW)
    others = [
        Column("group", [row.group for row in of]),
        Column("radius", radii, "m"),
        Column("status", states, bad=[state != FITTED for state in states]),
    ]
    fitted = [n for n, row in enumerate(of) if row.is_fitted]
    columns += [c for c in others if any(c.bad) or len({str(c.values[n]) for n in fitted}) > 1]
    first = [Column("curve", [row.name for row in of]), Column("verdict", verdicts)]
    caption = "Each curve on its own, with its 95 % intervals."
    return Table([*first, *columns], caption, folded=len(of) > _MANY)


def groups(of: Sequence[Row], *, si: bool = False) -> Table:
    """Return a row for each parameter of each group of curves; no columns without any."""
    parts, cells, units = summary(of), [], dict[str, Scale]()
    heads = ["group", "parameter", "accepted", "open", "outliers", "median", "quartiles"]
    if has_error := any("common_error" in part for part in parts):
        heads.append("common error")
    for part in parts:
        name = part["parameter"]
        if (unit := units.get(name)) is None:
            unit = units[name] = _usual([row.fit.estimates().get(name) for row in of], si)
        low, median, high = (unit.number(part[name]) for name in QUARTILES[1:4])
        counts = f"{part['n']} of {part['curves']}", str(part["open"]), str(part["outliers"])
        named = part["group"], f"{words(name)} [{unit.unit}]"
        error = f"± {unit.number(e, FEW)}" if (e := part.get("common_error")) else ""
        ends = median, f"{low} to {high}"
        if part["no_sign"] == part["n"]:
            ends = "no sign", ""
        cells.append((*named, *counts, *ends, *([error] if has_error else [])))
    caption = "All accepted curves; open, those that quote no value."
    return Table.of_rows(heads, cells, caption) if cells else Table([])


def _unit(fit: Record, name: str, si: bool) -> Scale:
    """Return the unit of a quantity in all tables of a fit: its own or, if it is 0, of rivals."""
    own = fit.estimates()[name]
    if own.value or own.high:
        return scale_of(own, si=si)
    others = (one["parameters"].get(name) for one in fit.data["explanations"])
    return unit_of([e["value"] for e in others if e is not None], own.unit, si=si)


def _usual(of: Sequence[Estimate | None], si: bool) -> Scale:
    """Return the unit of a quantity in all tables of curves: that of the median upper end."""
    found = [e for e in of if e is not None]
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
        (quote_estimate(e, unit, digits) if wanted else unit.number(e.value, digits)) if e else ""
        for e, wanted in zip(of, sought or [True] * len(of), strict=True)
    ]
    head = f"{words(name)} [{unit.unit}]"
    return [Column(head, texts, meaning="with its 95 % interval")] if any(of) else []
