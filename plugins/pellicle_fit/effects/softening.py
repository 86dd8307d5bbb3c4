"""A solid that softens as it is indented."""

from dataclasses import replace
from typing import Annotated, ClassVar, Literal

import numpy as np

from pellicle_fit.effect import Array, Bends, Contact, Fitted, fitted

_LIMIT = 0.5
"""Depth over L up to which the force of any indenter grows."""


class Softening(Bends, title="a solid that softens"):
    """Solid whose force falls behind as it is indented: A = A₁ (1 − δ/L), for δ ≤ L/2.

    The first order of a stress that grows less than the strain, or of a modulus that falls with
    depth; for a sphere on a neo-Hookean solid L is 6.7 R (Zhang, Cao, Li & Feng 2014).
    """

    type: Literal["softening"] = "softening"
    examples = ({}, {"softening_length": "10 um"})
    rank: ClassVar[int] = 2
    softening_length: Annotated[
        float, Fitted("m", above=0, log=True, starts=(3.0, 10.0), limits=(0.5, 1e3))
    ] = fitted("length L over which it softens [m]")

    def contact(self, contact: Contact) -> Contact:
        """Return the contact with the solid that softens."""

        def area(depth: Array, length: float) -> Array:
            return contact.area(depth, length) * (1 - depth / self.softening_length)

        limit = np.minimum(contact.depth_limit, _LIMIT * self.softening_length)
        return replace(contact, area=area, depth_limit=limit, half_space=False)
