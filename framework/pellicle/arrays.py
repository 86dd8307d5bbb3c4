"""Types of arrays and of their datasets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from xarray import DataArray as DataArray
    from xarray import Dataset as Dataset
else:
    # Annotations alone name them, and xarray takes longer to import than all that reads no result.
    DataArray = Dataset = Any

Array = NDArray[np.float64]
"""Real numbers."""
Mask = NDArray[np.bool_]
"""True or false for each cell."""
Cells = NDArray[np.int64]
"""Flat indices of cells."""
