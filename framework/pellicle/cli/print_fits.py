"""What is printed of fits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from .printing import print_table

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pellicle.fitting.fit import Fit
    from pellicle.fitting.pooled import PooledFit
    from pellicle.fitting.statistics.profile import Estimate


def print_fit(fit: Fit | PooledFit) -> None:
    """Print the estimates of a fit and what it says; of a pool, a line for each curve."""
    from pellicle.fitting.pooled import PooledFit

    _print_estimates(fit.estimates())
    if isinstance(fit, PooledFit):
        _print_curves(fit)
        said = [fit.comparison, fit.agreement, fit.advice]
        own = [f"{curve.name}: {message}" for curve in fit.curves for message in curve.messages]
    else:
        typer.echo(f"noise: {fit.noise:.3g} N, from {fit.noise_from}; {fit.points} points")
        said, own = [fit.comparison, fit.advice], []
    for line in filter(None, said):
        typer.echo(line)
    for message in (*fit.messages, *own):
        typer.echo(f"note: {message}", err=True)


def print_fits(rows: list[dict[str, Any]]) -> None:
    """Print a line for each curve; what the fits themselves say is in the table that is kept."""
    names = {"reduced_modulus": "Pa", "tension": "N/m", "contact_point": "m"}
    shown = []
    for row in rows:
        line = {"curve": row["curve"]}
        for name, unit in names.items():
            found = row.get(name, {})
            line[f"{name} [{unit}]"] = f"{found['value']:.4g}" if found else ""
            if name != "contact_point":
                told = found and not found["held"]
                line[f"95 % of {name}"] = _interval(found["low"], found["high"]) if told else ""
        verdict, _, reason = row["status"].partition(": ")
        codes = ", ".join(check["code"] for check in row.get("failed_checks", ()))
        notes = str(len(row.get("messages", ())))
        shown.append(line | {"failed checks": codes, "notes": notes, "status": verdict})
        if reason:
            typer.echo(f"{row['curve']}: {reason}", err=True)
    print_table(list(shown[0]), shown)


def _print_curves(fit: PooledFit) -> None:
    rows = []
    for curve in fit.curves:
        point = {"contact_point [m]": f"{curve.contact_point.value:.6g}"}
        if fit.contact_points:
            point["95 % of contact_point"] = _ends(curve.contact_point)
        own = {
            "noise [N]": f"{curve.noise:.3g}",
            "points": str(curve.points),
            "chi_squared": f"{curve.chi_squared:.5g}",
            "alone: reduced_modulus [Pa]": f"{curve.reduced_modulus_alone:.4g}",
            "tension [N/m]": f"{curve.tension_alone:.4g}",
        }
        rows.append({"curve": curve.name, **point, **own})
    print_table(list(rows[0]), rows)


def _print_estimates(estimates: Mapping[str, Estimate]) -> None:
    rows = []
    for name, estimate in estimates.items():
        value, ends = f"{estimate.value:.4g}", _ends(estimate)
        rows.append({"": name, "value": value, "95 % interval": ends, "unit": estimate.unit})
    print_table(["", "value", "95 % interval", "unit"], rows)


def _ends(estimate: Estimate) -> str:
    return "held" if estimate.held else _interval(estimate.low, estimate.high)


def _interval(low: float | None, high: float | None) -> str:
    ends = ("open" if end is None else f"{end:.4g}" for end in (low, high))
    return " to ".join(ends)
