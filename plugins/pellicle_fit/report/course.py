"""The figure of forces over time, of curves with a hold."""

from __future__ import annotations

from pellicle.components import Axis, Chart, Look, Series
from pellicle_fit.contact.curve import Curve
from pellicle_fit.result import Fit


def has_hold(curve: Curve) -> bool:
    """Return whether the base rests after the approach, at times that are known."""
    return curve.time is not None and bool(curve.rests.any())


def chart_over_time(fit: Fit) -> Chart:
    """Return force and fit over the time since the first row, of each curve with a hold."""
    series = list[Series]()
    pairs = zip(fit.answer.selected.all_rows, fit.forces(), strict=True)
    for number, (curve, force) in enumerate(pairs):
        if not has_hold(curve):
            continue
        time = curve.clock - curve.clock[0]
        legends = ("", "") if series else ("data", "fit")
        series.append(Series(time, curve.force, legend=legends[0], look=Look(None, None, 0)))
        series.append(Series(time, force, legend=legends[1], look=Look(number, number)))
    return Chart(Axis("time", "s"), [Axis("force", "N")], series, hues=max(len(fit.curves), 2))
