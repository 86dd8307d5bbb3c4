"""Physics holds with every registered solver."""

from __future__ import annotations

import pytest

import pellicle as pl


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test that asks for a ``solver`` once with each."""
    if "solver" in metafunc.fixturenames:
        metafunc.parametrize("solver", sorted(pl.registry().components["solver"]))
