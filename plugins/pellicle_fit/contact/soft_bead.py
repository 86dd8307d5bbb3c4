"""A bead that yields too: contacts of a sample and a bead, each with its skin."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, cast

import numpy as np
from numpy.polynomial.chebyshev import chebval3d, chebvander

from pellicle.arrays import Array
from pellicle.components import ForceCurve, HasForceCurve

from .area_table import half_space
from .contact import Area, OwnArea

RATIOS: Array = np.array([0.0, 0.15, 0.8, 3.0, 20.0])
"""Nodes of s₁ over a = ¾ F₀/E*δ, F₀ being the force on a rigid bead without tension."""
SHARES: Array = np.array([0.2, 0.5, 0.8])
"""Nodes of the share of the bead in the compliance of both springs."""
_LEAST = 1e-300


@dataclass(frozen=True, eq=False)
class SoftBead:
    """A bead of known reduced modulus E₂ and tension on a sample of E₁, to be determined.

    The force is about that of two springs, the sample alone and the bead alone. Without skins it is
    exactly that; with skins the logarithm of what is left is interpolated between simulated
    contacts, and vanishes where one of both is rigid.
    """

    rigid: HasForceCurve
    """The same bead, rigid."""
    modulus: float
    """E₂ [Pa]."""
    length: float
    """s₂ = 2τ₂/E₂ [m]."""
    depths: Array | None = None
    """Depths of simulated contacts [m]; None without skins."""
    forces: Array | None = None
    """F/E₁ [m²] at these, `RATIOS` and `SHARES`, of shape (k, n, m)."""
    accuracy: float = 0.0
    """Largest relative change of some forces when the cells along each axis are halved."""

    half_space: ClassVar[bool] = False

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force is known."""
        return self.rigid.depth_limit if self.depths is None else float(self.depths[-1])

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return F/E₁ on a sample so soft that the bead is rigid."""
        return self.rigid.force_curve(depth, length)

    def nodes(self, depths: Array) -> tuple[Array, Array, Array]:
        """Return s₁ [m] of `RATIOS`, F/E₁ on the sample alone, and E₁/E₂ of `SHARES`.

        They are those at depths [m] of shape (k,), of shapes (k, n, 1), (k, n, 1) and (k, n, m).
        """
        lengths = np.outer(0.75 * self.rigid.force_curve(depths, 0.0).force / depths, RATIOS)
        sample = [
            [self.rigid.force_curve(depths[i : i + 1], s).force[0] for s in row]
            for i, row in enumerate(lengths.tolist())
        ]
        bead = self.rigid.force_curve(depths, self.length).force[:, None, None]
        alone = np.array(sample)[:, :, None]
        return lengths[:, :, None], alone, SHARES / (1 - SHARES) * bead / alone

    @cached_property
    def _left(self) -> Array:
        """Coefficients of what is left over w(1 − w), w being the share."""
        assert self.depths is not None
        assert self.forces is not None
        _, sample, _ = self.nodes(self.depths)
        left = np.log(self.forces / sample / (1 - SHARES)) / (SHARES * (1 - SHARES))
        places = self._place(self.depths), 1 - 2 / (1 + RATIOS), 2 * SHARES - 1
        inverses = [np.linalg.inv(chebvander(place, place.size - 1)) for place in places]
        return np.asarray(np.einsum("ai,bj,ck,ijk->abc", *inverses, left))

    def _place(self, depth: Array) -> Array:
        """Return where a depth lies between those simulated, from −1 to 1; to −2 below them."""
        assert self.depths is not None
        low, high = np.log(self.depths[[0, -1]])
        place = 2 * (np.log(np.maximum(depth, _LEAST)) - low) / (high - low) - 1
        return np.asarray(np.clip(place, -2.0, 1.0))

    def area(self, deepest: float, size: float, modulus: float) -> Area:
        """Return F/E₁ [m²] beside a sample of a modulus E₁ [Pa], a number or a column of trials."""
        reach = min(deepest, self.rigid.depth_limit)
        own = OwnArea(half_space(cast("Hashable", self.rigid), reach), size, size)
        softer = modulus / self.modulus

        def area(depth: Array, length: float) -> Array:
            alone = own(depth, length)
            sample, bead = (np.maximum(of, _LEAST) for of in (alone, own(depth, self.length)))
            # Beside the compliance of the sample, which is 1.
            share = 1 - 1 / (1 + softer * sample / bead)
            total = sample * (1 - share)
            if self.depths is not None:
                radius = 0.75 * own(depth, 0.0) / np.maximum(depth, _LEAST)
                x = length / np.maximum(radius, _LEAST)
                at = np.broadcast_arrays(self._place(depth), 1 - 2 / (1 + x), 2 * share - 1)
                left = chebval3d(at[0], at[1], at[2], self._left)
                total = total * np.exp(share * (1 - share) * left)
            return np.where(alone > 0, total, 0.0)

        return area
