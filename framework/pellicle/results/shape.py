"""Which measures of a contact mean something."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from pellicle.variables import CORRECTED_FRACTION

if TYPE_CHECKING:
    import xarray as xr

_AXES: Final = {"semi_major_axis", "semi_minor_axis", "major_axis_angle"}
_OF_A_PERIOD: Final = {"contact_fraction", "mean_pressure"}
_ROUND: Final = 1e-9


def has_one_shape(data: xr.Dataset) -> bool:
    """Return whether the contact is always in one part, which a radius and an ellipse describe."""
    return "patches" in data and not bool((data["patches"] > 1).any())


def is_periodic(data: xr.Dataset) -> bool:
    """Return whether the domain of a result, or of some run of a study, repeats."""
    return bool(data.attrs["boundary"] == "periodic")


def means_something(data: xr.Dataset, name: str) -> bool:
    """Return whether a variable has a meaning for the contacts of a result or of a study.

    A contact in several parts has neither radius nor ellipse, and a round one no axes besides its
    radius. On a free domain the area of the domain is arbitrary, and so is a share of it.
    """
    if name in {"contact_radius", *_AXES} and not has_one_shape(data):
        return False
    if name in _AXES:
        major, minor = data["semi_major_axis"].values, data["semi_minor_axis"].values
        return bool(np.any(major - minor > _ROUND * major))
    if name in _OF_A_PERIOD or name.startswith(CORRECTED_FRACTION):
        return is_periodic(data)
    return True
