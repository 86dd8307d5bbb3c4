"""Datasets of HDF5 files whose numbers are elsewhere, packed or missing."""

from __future__ import annotations

from typing import Any

import numpy as np


def fault_of_source(dataset: Any) -> str:
    """Return what to do with a dataset that takes values from other files, which no hash covers."""
    if not (dataset.is_virtual or dataset.external):
        return ""
    return f"takes {dataset.name.strip('/')} from other files; copy it into one (h5repack)"


def fault_of_packing(dataset: Any) -> str:
    """Return what to do with a dataset whose numbers an attribute scales, as NetCDF packs them."""
    for name, plain in (("scale_factor", 1), ("add_offset", 0)):
        if dataset.attrs.get(name, plain) != plain:
            return (
                f"has {dataset.name.strip('/')} packed by its attribute {name}; write it unpacked"
            )
    return ""


def hdf5_numbers(dataset: Any) -> Any:
    """Return the numbers of a dataset; NaN where they are the one that it states for missing."""
    values = dataset[...]
    if (mark := dataset.attrs.get("_FillValue")) is None or values.dtype.kind not in "fiu":
        return values
    return np.where(values == mark, np.nan, values)
