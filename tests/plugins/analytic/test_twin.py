"""The semi-analytic twin of a run is the contact that the run prescribes."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle_plugins.analytic.reference import contact


@pytest.mark.parametrize(
    ("prescribed", "value", "what"),
    [
        ("depth", 1e-5, "depth"),
        ("force", 1e-5, "force"),
        ("contact_radius", 1e-4, "contact_radius"),
        ("contact_area", np.pi * 1e-8, "contact_radius"),
    ],
)
def test_twin_of_each_prescription(prescribed: str, value: float, what: str) -> None:
    """Whatever is prescribed, the twin has it, and none at zero."""
    run = pl.Run(
        grid={"points": 8, "size": "0.5 mm"},
        kernel={"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "10 mN/m"},
        indenter={"type": "paraboloid", "radius": "1 mm"},
        loading={prescribed: [0.0, value]},
    )
    made = xr.Dataset(attrs={"configuration": run.to_json()})
    assert contact(made, 1) is None
    found = contact(made, 2)
    expected = 1e-4 if prescribed == "contact_area" else value
    assert getattr(found, what) == pytest.approx(expected, rel=1e-9)
