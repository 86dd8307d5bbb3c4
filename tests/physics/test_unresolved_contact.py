"""A contact that the cells do not resolve is said to be so."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pellicle as pl
from tests.physics.tables_of_runs import half_space, heights, paraboloid

RADIUS, MODULUS = 1e-3, 1e4
POINTS, SIZE = 32, 5e-4
COARSE = "too coarse for this contact"


def pressed(points: Any = POINTS, indenter: Any = None, **loading: Any) -> pl.Result:
    """Return a paraboloid, or another indenter, on a half-space."""
    return pl.run(
        {
            "grid": {"points": points, "size": SIZE},
            "kernel": half_space(MODULUS),
            "indenter": indenter or paraboloid(RADIUS),
            "loading": loading,
        },
        progress=False,
    )


def hertz(depths: Any) -> Any:
    """Return the force [N]."""
    return 4 / 3 * MODULUS * RADIUS**0.5 * np.asarray(depths) ** 1.5


@pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
@pytest.mark.parametrize("points", [POINTS, POINTS + 1])
def test_what_is_not_said_to_be_coarse_is_good(points: int) -> None:
    """Of contacts about a grid point or about a cell those without a word are good to 3 %."""
    depths = (np.linspace(0.1, 4, 40) * SIZE / points) ** 2 / RADIUS
    result = pressed(points, depth=depths)
    coarse = [step - 1 for step, _ in result.coarse()]
    error = np.abs(result.dataset["force"].values / hertz(depths) - 1)
    assert result.converged
    assert np.delete(error, coarse).max() < 0.03
    assert error[coarse].max() > 0.5
    # The words come with few cells only, so not for ever.
    assert coarse == list(range(len(coarse)))
    assert len(coarse) < 25


def test_a_contact_between_the_cells_is_warned_of() -> None:
    """A depth at which no cell touches makes no force, and is not passed over in silence."""
    with pytest.warns(pl.ConvergenceWarning, match=f"step 1 and 1 more: .*{COARSE}.* none of them"):
        result = pressed(depth=[1e-9, 2e-9, 2e-5])
    assert result.dataset["force"].values[0] == 0
    assert [step for step, _ in result.coarse()] == [1, 2]


def test_no_load_is_not_coarse() -> None:
    """Nothing prescribed is nothing to resolve, and without force the lowest point just touches."""
    result = pressed(force=["20 uN", 0])
    assert list(result.dataset["status"].values) == ["converged", "converged"]
    assert result.dataset["depth"].values[1] == 0
    assert pressed(depth=0).dataset["status"].item() == "converged"


ONE_LINE = heights(-(np.linspace(-1e-2, 1e-2, 64)[:, None] ** 2))


@pytest.mark.parametrize(
    ("points", "indenter"),
    [
        (1, {}),
        ([1, 64], {}),
        ([64, 1], {}),
        ([64, 1], ONE_LINE),
        ([64, 1], {"type": "sum", "parts": [paraboloid(1e-3), ONE_LINE]}),
    ],
)
def test_a_free_grid_one_cell_wide_has_an_edge(points: Any, indenter: dict[str, Any]) -> None:
    """The contact reaches beyond a strip of cells, and beyond a single one."""
    words = "reaches the edge" if points == 1 else 'give grid.boundary = "periodic"'
    with pytest.warns(pl.ConvergenceWarning, match=words):
        result = pressed(points, indenter=indenter, depth=2e-5)
    code = "CONTACT_AT_EDGE" if points == 1 else "STRIP"
    assert result.dataset["status_code"].item() == code


@pytest.mark.parametrize(("x", "y"), [(-0.45, 0.0), (0.45, 0.0), (0.0, -0.45), (0.0, 0.45)])
def test_each_edge_of_a_free_domain_is_one(x: float, y: float) -> None:
    """A contact that leaves by one edge alone is told; turned, the problem is the same."""
    shifted = {"type": "shifted", "x": x * SIZE, "y": y * SIZE, "part": paraboloid(RADIUS)}
    with pytest.warns(pl.ConvergenceWarning, match="reaches the edge"):
        result = pressed(indenter=shifted, depth=2e-5)
    assert result.dataset["status_code"].item() == "CONTACT_AT_EDGE"


def test_a_zone_that_reaches_the_edge_has_words_of_its_own() -> None:
    """Without contact it is the zone that needs room; with room the same is said of neither."""
    run: dict[str, Any] = {
        "kernel": {"type": "half_space", "reduced_modulus": 1.0},
        "indenter": {"type": "paraboloid", "radius": 10.0},
        "interaction": {"type": "dugdale", "work_of_adhesion": 1e-4, "range": 1.0},
        "loading": {"depth": -0.5},
    }
    for boundary in ("free", "periodic"):
        grid = {"points": 10, "size": 1.0, "boundary": boundary}
        with pytest.warns(pl.ConvergenceWarning, match="the zone in which the interaction pulls"):
            data = pl.run({**run, "grid": grid}, progress=False).dataset
        assert data["status_code"].item() == "ZONE_AT_EDGE"
        assert not data["contact"].any()
        data = pl.run({**run, "grid": {**grid, "points": 24, "size": 12.0}}, progress=False).dataset
        assert data["converged"].all()
