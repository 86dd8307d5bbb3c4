"""A measured force curve that lies over the computed one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array


class Measured(NamedTuple):
    """A measured force curve."""

    position: Array
    """Position that grows into the solid [m], shape (n,)."""
    force: Array
    """Force [N], shape (n,)."""

    @property
    def touch(self) -> float:
        """The position at which the force reaches 5 % of its range [m]."""
        low, high = float(self.force.min()), float(self.force.max())
        above = self.force > low + 0.05 * (high - low)
        return float(self.position[int(np.argmax(above))])

    @property
    def touch_share(self) -> float:
        """How far along the positions `touch` lies, between 0 and 1."""
        return (self.touch - float(self.position.min())) / float(np.ptp(self.position))

    def depth(self, share: float) -> Array:
        """Return the depths [m], shape (n,), if contact begins at a share of the positions."""
        return self.position - float(self.position.min()) - share * float(np.ptp(self.position))
