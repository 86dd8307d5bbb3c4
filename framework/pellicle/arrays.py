"""Types of arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Real numbers."""
Mask = NDArray[np.bool_]
"""True or false for each cell."""
Cells = NDArray[np.int64]
"""Flat indices of cells."""
