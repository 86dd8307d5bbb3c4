"""The figure of complex moduli over frequency."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pellicle.components import Axis, Chart, Look, Series
from pellicle_fit.dynamic import explained_moduli
from pellicle_fit.result import Fit

_POINTS, _BEYOND = 61, 2.0
"""Points of a line, and how far it goes beyond the frequencies of sines, as a factor."""


def chart_of_sines(fit: Fit) -> Chart:
    """Return E′ and E″ of the reduced modulus over frequency, measured and by the explanation."""
    selected, series, rows = fit.answer.selected, list[Series](), iter(fit.sines)
    for number, (known, curve) in enumerate(zip(selected.known, selected.all_rows, strict=True)):
        if not curve.sines:
            continue
        told = [next(rows) for _ in curve.sines]
        frequency = np.array([sine["frequency"].value for sine in told])
        at = np.geomspace(frequency.min() / _BEYOND, frequency.max() * _BEYOND, _POINTS)
        dense = tuple(curve.sines[0]._replace(frequency=float(f)) for f in at)
        modulus = explained_moduli(known, replace(curve, sines=dense))
        for name, line, hue in (("storage", modulus.real, 0), ("loss", modulus.imag, 1)):
            hue = 2 * number + hue
            label = f"{name} modulus" if number == 0 else ""
            series.append(Series(at, _positive(line), look=Look(hue, hue)))
            for k, sine in enumerate(told):
                of = sine[f"{name}_modulus"]
                ends = (np.array([end]) for end in (of.low, of.high))
                low, high = (_positive(end) for end in ends)
                value, x = _positive(np.array([of.value])), frequency[[k]]
                legend = label if k == 0 else ""
                look = Look(hue, None, number)
                series.append(Series(x, value, legend=legend, look=look, low=low, high=high))
    y = Axis("storage and loss modulus", "Pa", log=True)
    return Chart(Axis("frequency", "Hz", log=True), [y], series, hues=2 * len(fit.curves))


def _positive(values: np.ndarray) -> np.ndarray:
    """Return values, of which a logarithmic axis shows those > 0."""
    return np.where(values > 0, values, np.nan)
