"""Values of nested models, tables and lists by their dotted path."""

from __future__ import annotations

from typing import Any

import pytest

import pellicle as pl
from pellicle.schema.model import get, walk

RUN = pl.Run(
    grid={"points": [8, 16], "size": "1 mm"},
    kernel=pl.kernel("coated", tension=0.1, substrate={"type": "half_space", "reduced_modulus": 1}),
    indenter=pl.indenter("sphere", radius=1e-3),
    loading={"depth": ["1 um", "2 um"]},
)
TABLE = {"study": {"vary": {"kernel.tension": [1, 2]}}, "parts": [{"a": None}]}


@pytest.mark.parametrize(
    ("at", "path", "value"),
    [
        (RUN, "grid.points.1", 16),
        (RUN, "grid.points.2", None),
        (RUN, "kernel.substrate.reduced_modulus", 1.0),
        (RUN, "kernel.nothing.more", None),
        (TABLE, "study.vary.kernel.tension", [1, 2]),
        (TABLE, "study.vary.kernel.tension.1", 2),
        (TABLE, "parts.x", None),
        (TABLE, "parts.0.a.b", None),
    ],
)
def test_get(at: object, path: str, value: Any) -> None:
    """A path leads through models, tables and lists, or to None."""
    assert get(at, path) == value


def test_walk_and_get_agree() -> None:
    """Every value that a walk yields is found at its path; fields come with what describes them."""
    walked = {path: (value, field) for path, value, field in walk(RUN)}
    assert all(get(RUN, path) == value for path, (value, _) in walked.items())
    assert {"grid.size.0", "kernel.substrate", "kernel.substrate.type", "solver.tolerance"} <= {
        *walked
    }
    assert walked["grid.size.1"][1] is walked["grid.size"][1]
    assert [path for path, _, _ in walk({"a": [1, {"b": 2}]})] == ["a", "a.0", "a.1", "a.1.b"]
