"""The contact-boundary correction of the contact area."""

from __future__ import annotations

from math import log, pi
from typing import Literal

import numpy as np
from pydantic import ConfigDict

from pellicle.arrays import Mask
from pellicle.components import AreaCorrection, Boundary


class Yastrebov(AreaCorrection):
    """Correction by the length of the contact's boundary (Yastrebov, Anciaux & Molinari 2017)."""

    model_config = ConfigDict(title="Yastrebov")

    type: Literal["yastrebov"] = "yastrebov"
    examples = ({},)

    def area(self, contact: Mask, spacing: tuple[float, float], boundary: Boundary) -> float:
        """Return A − (π − 1 + ln 2)/24 · S·Δ [m²].

        S·Δ sums, over all switches between contact and no contact along x and y, the switched
        cell edge times the spacing across it: both give dx·dy. Those across a periodic edge count.
        """
        periodic, switches = boundary == "periodic", 0
        for axis in (0, 1):
            before = np.roll(contact, 1, axis) != contact
            switched = before if periodic else np.diff(contact, axis=axis)
            switches += int(np.count_nonzero(switched))
        covered = np.count_nonzero(contact)
        return spacing[0] * spacing[1] * (covered - (pi - 1 + log(2)) / 24 * switches)
