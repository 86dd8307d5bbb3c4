"""Lines that guide the eye in charts of fits."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pellicle.components import Look, Series


def guide(x: Sequence[float], y: Sequence[float], legend: str = "", panel: int = 0) -> Series:
    """Return a thin dotted line, whose numbers are not written."""
    ends, look = (np.array(x, dtype=float), np.array(y, dtype=float)), Look(None, 3)
    return Series(*ends, legend=legend, look=look, role="reference", panel=panel, written=False)
