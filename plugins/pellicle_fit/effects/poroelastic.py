"""A gel that drains: the force is carried by its liquid first, and by its solid at last."""

from collections.abc import Callable, Iterable, Mapping
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from pellicle_fit.effect import Array, Contact, Curve, Fitted, Sizes, Values, fitted

from .relaxing import Relaxing

_MEANS = {
    "open": (
        (1.6103, 2.1046, 3.0558, 5.0817, 5.815),
        (0.8814, 1.4212, 0.884, 2.4665, 1.5486),
    ),
    "sealed": (
        (1.0491, 0.6993, 1.0783, 1.7336, 1.0012),
        (0.5944, 0.463, 0.5739, 0.7037, 0.1946),
    ),
}
"""Coefficients of the mean of g, and what each grows by with ν / (1 − ν), as
tests/benchmarks/draining.py fits them."""
_WIDER = {"open": 1.5, "sealed": 0.9}
"""Growth of a² under a tension, over a s: what is pressed is wider than the contact."""
_DRAINED = 1e-12
"""a²/(Dt) below which nothing is left to drain."""
_ROUND, _OTHER, _TENSED = 0.007, 0.015, 0.045
"""Errors of the force for a round tip, for any other and under a tension, against solutions of the
whole problem."""


class Poroelastic(Relaxing, title="draining"):
    """Porous solid whose liquid drains (Biot 1941), with E* that of the drained solid.

    A contact of radius a that is made at once has the force F∞ (1 + (1 − 2ν) g(Dt/a²)), where g is
    that of a paraboloid. While it grows, each part of the force relaxes as one of its present size.
    """

    type: Literal["poroelastic"] = "poroelastic"
    sees_tension: ClassVar[bool] = True
    examples = ({}, {"drained_ratio": 0.2, "diffusivity": "100 um^2/s", "surface": "sealed"})
    drained_ratio: Annotated[float, Fitted("1", at_least=0, at_most=0.5)] = fitted(
        "Poisson's ratio ν of the drained solid"
    )
    diffusivity: Annotated[float, Fitted("m2/s", above=0, log=True)] = fitted(
        "diffusivity D of the liquid [m²/s]"
    )
    surface: Literal["open", "sealed"] = Field(
        "open", description="whether liquid leaves by the surface"
    )

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse curves that unload, and contacts with more than a half-space."""
        if curve.moves_out.any():
            return "of a solid that drains there is no theory of unloading"
        return super().excuse(contact, curve, beside)

    def accuracy(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> float:
        """Return the error of the force over the largest one."""
        if np.any(contact.tension):
            return _TENSED
        return _ROUND if contact.tip_radius else _OTHER

    def limits(self, sizes: Sizes) -> Mapping[str, tuple[float, float]]:
        """Return diffusivities by which a hundredth of the force drains, or all but that."""
        of_path = sizes.length**2 / sizes.time
        return {"diffusivity": (1e-4 * of_path, 1e5 * of_path)}

    def starts(self, sizes: Sizes) -> Iterable[Values]:
        """Yield draining over widths of a contact that are parts of the path, and longer."""
        of_path = sizes.length**2 / sizes.time
        for part in (0.03, 1.0, 30.0):
            yield {"drained_ratio": 0.2, "diffusivity": part * of_path}

    def primitive(self, time: Array) -> Array:
        """Return ∫ E(t) dt / E* [s] of a contact so wide that nothing drains."""
        return 2 * (1 - self.drained_ratio) * time

    def _growing(self, nodes: Array, radius: Callable[[], Array], length: Array) -> Array:
        """Return ∫ 1 + (1 − 2ν) g(D (t − t′)/a²) dt′ [s] over intervals, a that at t."""
        a = np.broadcast_to(radius(), nodes.shape)[:, 1:, None]
        passed = np.maximum(nodes[:, 1:, None] - nodes[:, None, :], 0.0)
        return -np.diff(self.held(passed, a, length), axis=2)

    def held(self, time: Array, radius: Array, length: Array | float) -> Array:
        """Return ∫ 1 + (1 − 2ν) g(Dt/a²) dt [s]."""
        flowed = self.diffusivity * time
        # A contact of no size has drained.
        squared = np.maximum(radius * (radius + _WIDER[self.surface] * length), _DRAINED * flowed)
        of_root = self._mean(np.sqrt(flowed / np.maximum(squared, 1e-300)))
        return time * (1 + (1 - 2 * self.drained_ratio) * of_root)

    def _mean(self, root: Array) -> Array:
        """Return the mean of g from 0 to Dt/a², given its root."""
        still, grows = np.array(_MEANS[self.surface])
        ratio = self.drained_ratio / (1 - self.drained_ratio)
        b1, b2, c1, c2, c3 = (s + g * ratio for s, g in zip(still, grows, strict=True))
        over = 1 + root * (c1 + root * (c2 + root * c3))
        return np.asarray((1 + root * (b1 + root * b2)) / over)
