"""The pressure along a line ends at the rim of the contact, against the axisymmetric solution."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.components import Chart, Table
from pellicle.results.runs import StoredRuns
from pellicle.show import up_to_rim
from pellicle_axisymmetric.indentation import indent
from pellicle_plugins.indenters.of_revolution import Paraboloid
from pellicle_plugins.outputs.profiles import Profiles
from pellicle_plugins.outputs.step_figures import profile

RADIUS, MODULUS, DEPTH, SIZE = 1e-3, 10e3, 50e-6, 0.8e-3


@pytest.mark.parametrize("tension", [0.0, 0.1, 1.0])
@pytest.mark.parametrize("points", [64, 81])
def test_the_line_is_the_solution(tension: float, points: int) -> None:
    """Up to the rim it is within 3 % of the highest pressure, where single cells miss by 80 %."""
    result = pl.run(
        {
            "grid": {"points": points, "size": SIZE},
            "kernel": {"type": "tensed_membrane", "reduced_modulus": MODULUS, "tension": tension},
            "indenter": {"type": "paraboloid", "radius": RADIUS},
            "loading": {"depth": DEPTH},
            "corrections": [{"type": "yastrebov"}],
        },
        progress=False,
    )
    series = profile(result).series[0]
    exact = indent(Paraboloid(radius=RADIUS), MODULUS, tension, depth=DEPTH)
    a, highest = exact.contact_radius, series.y.max()
    rim = series.x[series.y > 0].max()
    assert rim == pytest.approx(a, abs=0.2 * SIZE / points)
    y = result.grid.coordinates()[1][0, points // 2]
    inside = np.abs(series.x) < 0.99 * a
    r = np.hypot(series.x[inside], y)
    np.testing.assert_allclose(series.y[inside], exact.pressure(r), atol=0.03 * highest)
    np.testing.assert_array_equal(series.y[np.abs(series.x) > rim * (1 + 1e-9)], 0.0)
    # The line falls at the rim itself.
    np.testing.assert_array_equal(np.diff(series.x) >= 0, True)
    assert (np.diff(series.x) == 0).sum() == 2
    # Marks beside the solution are those of the cells that the line keeps.
    runs = StoredRuns.of_run(result.dataset)
    numbers, chart = (part for _, part in Profiles(reference="axisymmetric").charts(runs))
    assert isinstance(chart, Chart)
    marks, solution = chart.series
    expected = np.interp(marks.x, solution.x, solution.y)
    np.testing.assert_allclose(marks.y, expected, atol=0.03 * highest)
    assert marks.x.size > 50
    assert isinstance(numbers, Table)
    assert [*numbers.columns[1].values].count("run") == points


def test_an_elliptic_contact_has_a_rim() -> None:
    """Hertz's pressure along both axes of an ellipse, p₀ √(1 − x²/a²)."""
    result = pl.run(
        {
            "grid": {"points": 96, "size": SIZE},
            "kernel": {"type": "half_space", "reduced_modulus": MODULUS},
            "indenter": {"type": "quadric", "radius_x": "1 mm", "radius_y": "3 mm"},
            "loading": {"depth": 30e-6},
        },
        progress=False,
    )
    series = profile(result).series[0]
    minor = float(result.dataset["semi_minor_axis"][0])
    inside = np.abs(series.x) < 0.98 * minor
    hertz = series.y.max() * np.sqrt(1 - (series.x[inside] / minor) ** 2)
    np.testing.assert_allclose(series.y[inside], hertz, atol=0.02 * series.y.max())


@pytest.mark.parametrize(
    ("contact", "pressure"),
    [
        ("...#####.....", "falls"),
        (".....##################...####....", "falls"),
        ("...##################........", "falls"),
        ("....####################....", "rises"),
    ],
    ids=["few cells", "two parts", "beside the middle", "a punch"],
)
def test_elsewhere_the_line_goes_through_the_cells(contact: str, pressure: str) -> None:
    """Coarse contacts, several, shifted ones and pressures that grow to the rim are left alone."""
    mask: Any = np.array([cell == "#" for cell in contact])
    x: Any = np.arange(mask.size) - (mask.size - 1) / 2
    half = mask.sum() / 2
    root = np.sqrt(np.clip(1 - (x / half) ** 2, 0.0, None))
    values: Any = np.where(mask, root if pressure == "falls" else 2 - root, 0.0)
    line = up_to_rim(x, values, mask, half)
    np.testing.assert_array_equal(line[0], x)
    np.testing.assert_array_equal(line[1], values)
