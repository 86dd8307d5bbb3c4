"""The contact-boundary correction of the contact area."""

from __future__ import annotations

from math import log, pi
from typing import Literal

import numpy as np
from pydantic import ConfigDict

from pellicle.arrays import Mask
from pellicle.components import AreaCorrection


class Yastrebov(AreaCorrection):
    """Correction by the length of the contact's boundary (Yastrebov, Anciaux & Molinari 2017)."""

    model_config = ConfigDict(title="Yastrebov")

    type: Literal["yastrebov"] = "yastrebov"
    examples = ({},)

    def area(self, contact: Mask, spacing: tuple[float, float]) -> float:
        """Return A − (π − 1 + ln 2)/24 · S·Δ [m²].

        S·Δ sums, over all switches between contact and no contact along x and y, the switched
        cell edge times the spacing across it: both give dx·dy.
        """
        along_x = np.count_nonzero(contact[1:] != contact[:-1])
        along_y = np.count_nonzero(contact[:, 1:] != contact[:, :-1])
        return _area(contact, int(along_x + along_y), spacing)

    def periodic_area(self, contact: Mask, spacing: tuple[float, float]) -> float:
        """Return the same on a periodic domain, including switches across its edges [m²]."""
        along_x, along_y = (
            np.count_nonzero(contact != np.roll(contact, 1, axis)) for axis in (0, 1)
        )
        return _area(contact, int(along_x + along_y), spacing)


def _area(contact: Mask, switches: int, spacing: tuple[float, float]) -> float:
    covered = np.count_nonzero(contact)
    return spacing[0] * spacing[1] * (covered - (pi - 1 + log(2)) / 24 * switches)
