"""Which measures of the shape of a contact mean something."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

_OF_ONE_PART: Final = {"contact_radius", "semi_major_axis", "semi_minor_axis", "major_axis_angle"}
_ROUND: Final = 1e-9


def has_one_shape(data: xr.Dataset) -> bool:
    """Whether the contact is never in several parts, so that its radius and ellipse describe it."""
    return "patches" in data and not bool((data["patches"] > 1).any())


def describes_shape(data: xr.Dataset, name: str) -> bool:
    """Whether a variable has a meaning for the contacts of a result or of a study.

    A contact in several parts has neither radius nor ellipse, and a round one no major axis.
    """
    if name in _OF_ONE_PART and not has_one_shape(data):
        return False
    return name != "major_axis_angle" or not _is_round(data)


def _is_round(data: xr.Dataset) -> bool:
    """Whether the axes of the ellipse are equal up to round-off wherever there is contact."""
    major, minor = data["semi_major_axis"].values, data["semi_minor_axis"].values
    return not bool(np.any(major - minor > _ROUND * major))
