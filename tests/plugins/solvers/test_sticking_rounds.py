"""Rounds of a contact that sticks: fronts that move too far are taken back."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest
import xarray as xr

from pellicle_plugins.solvers import adhesion
from tests.adhesive_paths import JKR, half_space, solved, wavy

WITHOUT_ESTIMATE: dict[str, Any] = {**JKR, "estimate_error": False}


def approach() -> xr.Dataset:
    """Return a path of two depths, whose second step has no extrapolation to start from."""
    return solved(24, 1.0, [0.1, 0.6], interaction=WITHOUT_ESTIMATE)


@pytest.mark.filterwarnings("ignore::pellicle.errors.ConvergenceWarning")
def test_rounds_whose_energy_rises_are_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Even if every shift is refused at first the path converges, to the same forces."""
    usual = approach()
    monkeypatch.setattr(adhesion, "_RISE", -1e9)
    refused = approach()
    assert refused["converged"].all()
    assert refused["force"].values == pytest.approx(usual["force"].values, rel=1e-6)
    more = refused["operator_applications"] > usual["operator_applications"]
    assert more.all()


@pytest.mark.filterwarnings("ignore::pellicle.errors.ConvergenceWarning")
def test_energies_are_compared_beyond_the_rim_of_an_indenter(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where there is no indenter, the gap is infinite."""
    punch = {"type": "flat_punch", "radius": 1.0}
    usual = solved(24, 1.0, [0.1], interaction=WITHOUT_ESTIMATE, indenter=punch)
    monkeypatch.setattr(adhesion, "_IDLE", 0)
    judged = solved(24, 1.0, [0.1], interaction=WITHOUT_ESTIMATE, indenter=punch)
    assert judged["converged"].all()
    assert judged["force"].values == pytest.approx(usual["force"].values, rel=1e-6)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::pellicle.errors.ConvergenceWarning")
@pytest.mark.parametrize("length", [0.0, 0.05, 0.3])
def test_lines_that_nearly_meet_converge(length: float) -> None:
    """Wide line contacts on a sine, whose fronts went to and fro by a cell without end."""
    pulls = [pi * 0.1 * share for share in (0.025, 0.15, 0.275, 0.4, 0.525, 0.4)]
    fractions = []
    for points in (512, 1024):
        path = wavy(
            points, pulls, 0.1, 1e-3, quantity="mean_pressure", kernel=half_space(length),
            interaction={"type": "jkr", "work_of_adhesion": 1e-3, "estimate_error": False},
        )  # fmt: skip
        assert path["converged"].all()
        fractions.append(path["contact_fraction"].values)
    assert (np.array(fractions) < 0.7).all()
    np.testing.assert_allclose(fractions[0], fractions[1], atol=0.01)
