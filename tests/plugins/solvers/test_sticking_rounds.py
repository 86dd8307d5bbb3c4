"""Rounds of a contact that sticks: fronts that move too far are taken back."""

from __future__ import annotations

from typing import Any

import pytest
import xarray as xr

from pellicle_plugins.solvers import adhesion
from tests.adhesive_paths import JKR, solved

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
