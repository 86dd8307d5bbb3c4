"""Gives every test of a contract each registered component in turn.

A test that takes ``kernel``, ``indenter``, … runs on each example of that family, one that takes
``component`` on all of them.
"""

from pathlib import Path
from typing import Any

import pytest

from pellicle.components import Component
from pellicle.components.installed import FAMILIES, registry
from pellicle.schema.from_file import paths_relative_to

EXAMPLES: dict[str, dict[str, dict[str, Any]]] = {
    family: {
        registered.type: dict(registered.examples[-1])
        for registered in members.values()
        if registered.origin.is_built_in
    }
    for family, members in registry().components.items()
}
DATA = Path(__file__).parents[1] / "data"

PROCESSES = "processes", "dask"
DRAWINGS = "curves", "profiles", "spectrum", "patches", "distributions"
"""Executors whose workers take seconds to start."""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test once for each example of the family it asks for."""
    for name in ({"component"} | FAMILIES.keys()) & set(metafunc.fixturenames):
        pairs = [
            pytest.param(
                (family, type_),
                marks=pytest.mark.slow if type_ in (*PROCESSES, *DRAWINGS) else (),
                id=f"{family}.{type_}",
            )
            for family, members in EXAMPLES.items()
            for type_ in members
            if name in ("component", family)
        ]
        metafunc.parametrize(name, pairs, indirect=True)


def _make(request: pytest.FixtureRequest) -> Component:
    family, type_ = request.param
    fields = EXAMPLES[family][type_]
    if type_ == "dask":
        fields = fields | {"address": request.getfixturevalue("dask_address")}
    with paths_relative_to(DATA):
        return registry().make(registry().families[family], {"type": type_, **fields})


for _name in ("component", *FAMILIES):
    globals()[_name] = pytest.fixture(_make, name=_name)


@pytest.fixture(scope="session")
def examples() -> dict[str, dict[str, dict[str, Any]]]:
    """Fields by family and type."""
    return EXAMPLES
