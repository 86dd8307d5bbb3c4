"""A surface that is stiffer or softer than the solid below."""

from dataclasses import replace
from typing import Annotated, ClassVar, Literal

import numpy as np

from pellicle_fit.effect import Array, Bends, Contact, Curve, Fitted, fitted

_NODES, _SHARES = np.polynomial.legendre.leggauss(10)
_ROOTS, _WEIGHTS = ((_NODES + 1) / 2) ** 2, _SHARES * (_NODES + 1) / 2
"""Nodes √(δ′/δ), dense at first touch, and weights of integrals over the depths δ′ of contacts."""


class StiffSurface(Bends, title="a surface stiffer or softer than the bulk"):
    """Surface stiffer or softer than the bulk: contacts of radius a have k = 2E*a (1 + g e^(−a/l)).

    A gradient of the modulus, or a film. With |g| ≤ ½: a surface stiffer than half again mimics any
    tension, for both are a stiffness over the contact radius.
    """

    type: Literal["stiff_surface"] = "stiff_surface"
    examples = ({}, {"gain": 0.3, "reach": "1 um"})
    rank: ClassVar[int] = 2
    gain: Annotated[float, Fitted("1", at_least=-0.5, at_most=0.5, starts=(0.3, -0.3))] = fitted(
        "relative excess g of the stiffness at the surface"
    )
    reach: Annotated[
        float, Fitted("m", above=0, log=True, starts=(0.3, 1.0, 3.0), limits=(0.01, 100.0))
    ] = fitted("length l over which it falls [m]")

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse a set with a tension, and a contact without a radius."""
        if "tension" in beside:
            return "a tension makes up for it"
        return "" if contact.is_bare_indenter else "needs an indenter with a contact radius"

    def contact(self, contact: Contact) -> Contact:
        """Return A = A₁ + ∫ 2a g e^(−a/l) dδ over the contacts of radius a, those of A₁."""
        bare, gain, reach = replace(contact, tension=0.0), self.gain, self.reach

        def area(depth: Array, _: float) -> Array:
            # The radius of round bodies is smooth in √δ.
            deep = np.maximum(depth, 0.0)
            table = bare.tabulated(1.01 * float(np.max(deep)))
            depths = deep[:, None] * _ROOTS**2
            # Interpolated, that of a body flat at its tip may be less than none.
            radius = np.maximum(table.radius(depths.ravel()), 0.0).reshape(depths.shape)
            excess = 4 * gain * radius * np.exp(-radius / reach) * _ROOTS @ _WEIGHTS
            return table.area(depth, 0.0) + deep * excess

        return replace(contact, area=area, half_space=False)
