"""The way to an end of an interval, where χ² is no smooth function."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from pellicle_fit.estimation.intervals import End, _Way
from pellicle_fit.estimation.search import Minimum


def test_end_where_chi_squared_jumps() -> None:
    """Where two searches find χ² on both sides of the end at one place, that is the end."""
    quantity = SimpleNamespace(log=False)
    slot = SimpleNamespace(quantity=quantity, value=lambda at: float(at))
    objective = SimpleNamespace(slots=[slot], limits=np.array([[-10.0], [10.0]]))
    at = np.zeros(1)

    def minimum(chi_squared: float) -> Minimum:
        found = SimpleNamespace(at=at, chi_squared=chi_squared)
        return cast("Minimum", found)

    way = _Way(cast("Any", objective), minimum(0.0), np.ones((4, 1)), 0, 1, 4.0)
    here = way.distance
    way.reached(minimum(100.0))
    assert way.distance < here
    # Searches of two starts disagree about one point.
    way.distance = here
    way.reached(minimum(0.0))
    assert way.ended
    assert way.kind is End.CLOSED
    assert way.end == pytest.approx(here)
