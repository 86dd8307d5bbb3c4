"""Result files of version 1, which count steps from 0 and have no status codes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .status import Status

if TYPE_CHECKING:
    import xarray as xr

_BEGINNINGS = {
    "converged; the contact area": Status.NEAREST_AREA,
    "converged, but the cells": Status.COARSE,
    "converged": Status.CONVERGED,
    "the pressure became": Status.NOT_FINITE,
    "the solver returned": Status.NEGATIVE_PRESSURE,
    "the surface misses": Status.CONTACT_RESIDUAL,
    "the surface penetrates": Status.PENETRATION,
    "pressure acts": Status.COMPLEMENTARITY,
    "the force misses": Status.LOAD,
    "the contact area misses": Status.AREA,
    "the contact stiffness": Status.STIFFNESS,
    "the contact reaches": Status.CONTACT_AT_EDGE,
    "not run": Status.NOT_RUN,
    "failed": Status.FAILED,
}
"""Status codes by the beginning of the message."""


def completed(content: xr.Dataset) -> xr.Dataset:
    """Return a result or a table of version 1 in the layout of the current version.

    Raises
    ------
    KeyError
        A status message is unknown.
    """
    if "step" in content.coords:
        attributes = content["step"].attrs
        content = content.assign_coords(step=content["step"] + 1)
        content["step"].attrs = attributes
    if "status" in content:
        messages = content["status"]
        codes = [_code(message) for message in messages.values.ravel()]
        shaped = np.array(codes, dtype=object).reshape(messages.shape)
        content = content.assign(status_code=(messages.dims, shaped))
    return content


def _code(message: str) -> str:
    if not message:
        return ""
    beginnings = (text for text in _BEGINNINGS if message.startswith(text))
    return _BEGINNINGS[next(beginnings, message)].name
