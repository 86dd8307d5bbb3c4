"""Sums of products over a field."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def dot(one: NDArray[Any], other: NDArray[Any]) -> float:
    """Return Σ one · other of two fields.

    Not by BLAS, whose threads keep a core busy waiting for more and take it from the transforms.
    """
    return float(np.einsum("i,i->", one.reshape(-1), other.reshape(-1)))
