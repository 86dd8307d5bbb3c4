"""A load that a grid does not attain leaves a result that is marked."""

from __future__ import annotations

import pytest

import pellicle as pl
from tests.command import Cli
from tests.framework.bad_input.command_line import says


def test_area_of_few_cells(cli: Cli) -> None:
    """An area that no number of whole cells comes near to is marked, one they nearly have said."""
    loading = "loading={contact_area=['4.7e-9 m**2', '4.6e-8 m**2']}"
    outcome = cli("run", "start.toml", "-o", "out", "--set", loading, code=1)
    says(outcome.stderr, "step 1 did not converge: the contact area misses", "use more points")
    says(outcome.stderr, "step 2: converged; the contact area misses", "nearer number of whole")
    kept = pl.load("out/start.h5").dataset
    assert kept["converged"].values.tolist() == [False, True]


@pytest.mark.parametrize(
    ("loading", "boundary", "named"),
    [
        ("{depth='1 mm'}", "free", "loading.depth = 1 mm"),
        ("{force='1 N'}", "free", "loading.force = 1 N"),
        ("{contact_area='0.19 mm**2'}", "free", "loading.contact_area = 0.19 mm²"),
        ("{mean_pressure='1 MPa'}", "periodic", "loading.mean_pressure = 1 MPa"),
    ],
)
def test_contact_reaches_the_edge(cli: Cli, loading: str, boundary: str, named: str) -> None:
    """A load beyond the domain's reach leaves a result that is marked, and exit code 1."""
    changes = ["--set", f"loading={loading}", "--set", f"grid.boundary='{boundary}'"]
    outcome = cli("run", "start.toml", "-o", "out", *changes, code=1)
    says(outcome.stderr, "step 1 did not converge", "reaches the edge", named)
    says(outcome.stderr, "enlarge grid.size = 447.2 µm × 447.2 µm or press in less far")
    kept = pl.load("out/start.h5").dataset
    assert not kept["converged"].item()
    assert "reaches the edge" in kept["status"].item()
    assert "NOT CONVERGED" in outcome.stdout
