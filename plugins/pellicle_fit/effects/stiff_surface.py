"""A surface that is stiffer or softer than the solid below."""

from dataclasses import replace
from typing import Annotated, ClassVar, Literal

import numpy as np

from pellicle_fit.contact.area_table import cubic, cubics
from pellicle_fit.effect import Array, Bends, Contact, Curve, Fitted, fitted

_NODES, _SHARES = np.polynomial.legendre.leggauss(10)
_ROOTS, _WEIGHTS = ((_NODES + 1) / 2) ** 2, _SHARES * (_NODES + 1) / 2
"""Nodes √(δ′/δ), dense at first touch, and weights of integrals over the depths δ′ of contacts."""

_STEPS = 64
"""Steps in √δ between which the integrals are interpolated."""


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
        gain, reach, deepest = self.gain, np.reshape(self.reach, (-1, 1)), contact.deepest
        step = np.sqrt(deepest) / _STEPS
        depths = (step * np.maximum(np.arange(_STEPS + 1), 1e-6)) ** 2
        bare = replace(contact, modulus=1.0, tension=0.0)
        # Interpolated, the radius of a body flat at its tip may be less than none.
        radii = np.maximum(bare.radius((depths[:, None] * _ROOTS**2).ravel()), 0.0)
        shares = (radii * np.exp(-radii / reach)).reshape(-1, _STEPS + 1, _ROOTS.size)
        excess = cubics(4 * (shares * _ROOTS) @ _WEIGHTS)

        def area(depth: Array, _: float) -> Array:
            deep = np.clip(depth, 0.0, deepest)
            of_surface = cubic(excess, np.sqrt(deep) / step, 1.0)
            return np.asarray(contact.area(depth, 0.0) + gain * deep * of_surface)

        return replace(contact, area=area, half_space=False)
