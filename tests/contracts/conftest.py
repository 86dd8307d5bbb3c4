"""Gives every test of a contract each registered component in turn.

A test that takes ``kernel``, ``indenter``, … runs on each example of that family, one that takes
``component`` on all of them.
"""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest

from pellicle.components import FAMILIES, Component
from pellicle.plugins import registry


def _load_examples() -> dict[str, dict[str, dict[str, Any]]]:
    # Test folders are no packages, so a neighbour cannot simply be imported.
    spec = spec_from_file_location("examples", Path(__file__).with_name("examples.py"))
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.EXAMPLES


EXAMPLES = _load_examples()


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test once for each example of the family it asks for."""
    for name in ({"component"} | FAMILIES.keys()) & set(metafunc.fixturenames):
        pairs = [
            (family, type_)
            for family, members in EXAMPLES.items()
            for type_ in members
            if name in ("component", family)
        ]
        metafunc.parametrize(name, pairs, ids=[".".join(pair) for pair in pairs], indirect=True)


def _make(request: pytest.FixtureRequest) -> Component:
    family, type_ = request.param
    fields = EXAMPLES[family][type_]
    if type_ == "dask":
        fields = fields | {"address": request.getfixturevalue("dask_address")}
    return registry().make(FAMILIES[family], {"type": type_, **fields})


for _name in ("component", *FAMILIES):
    globals()[_name] = pytest.fixture(_make, name=_name)


@pytest.fixture(scope="session")
def examples() -> dict[str, dict[str, dict[str, Any]]]:
    """Fields by family and type."""
    return EXAMPLES
