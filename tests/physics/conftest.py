"""Physics holds with every registered solver."""

import pytest

import pellicle as pl


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test that asks for a ``solver``, and names none, once with each."""
    named = [mark.args[0] for mark in metafunc.definition.iter_markers("parametrize")]
    if "solver" in metafunc.fixturenames and not any("solver" in names for names in named):
        metafunc.parametrize("solver", sorted(pl.registry().components["solver"]))
