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
        (7.0763, 13.2437, 13.9561, 52.4454, 30.7964),
        (4.7474, 8.5324, 1.937, 10.1159, 5.2718),
    ),
    "sealed": (
        (1.0491, 0.6993, 1.0783, 1.7336, 1.0012),
        (0.5944, 0.463, 0.5739, 0.7037, 0.1946),
        (0.0815, 0.4395, 0.1211, 0.3768, -0.7979),
        (1.2228, 0.1541, 1.094, 0.0876, -0.2168),
    ),
}
"""Coefficients of the mean of g, and what each grows by with b = ν / (1 − ν), with a part u of the
tension, and with b u, as tests/benchmarks/draining.py fits them."""
_WIDENS = {"open": (1.1485, 6.409), "sealed": (0.1677, 1.1912)}
"""By how much of s what drains is wider than the contact, and λ of u = s/(s + λa)."""
_DRAINED = 1e-12
"""a²/(Dt) below which nothing is left to drain."""
_PARTS = 6
"""Parts of a path, each of which sees no more of it than what came before its end."""
_ERRORS = {"open": (0.007, 0.015), "sealed": (0.013, 0.02)}
"""Errors of the force for a round tip, and for any other, against solutions of the whole problem;
those under a sealed surface are so smooth that less than twice as much covers what D makes of them.
"""


class Poroelastic(Relaxing, title="draining"):
    """Porous solid whose liquid drains (Biot 1941), with E* that of the drained solid.

    A contact of radius a that is made at once has the modulus E* (1 + (1 − 2ν) g(Dt/a²)), where g
    is that of a paraboloid and depends on s/a. While it grows, each part of the drained force
    relaxes as one of its present size.
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
        of_round, of_others = _ERRORS[self.surface]
        return of_round if contact.tip_radius else of_others

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
        count = nodes.shape[1] - 1
        weights = np.zeros((len(nodes), count, count))
        # Nothing relaxes before it is there.
        for part in np.array_split(np.arange(count), _PARTS):
            end = int(part[-1]) + 1
            passed = np.maximum(nodes[:, part + 1, None] - nodes[:, None, : end + 1], 0.0)
            weights[:, part, :end] = -np.diff(self.held(passed, a[:, part], length), axis=2)
        return weights

    def held(self, time: Array, radius: Array, length: Array | float) -> Array:
        """Return ∫ 1 + (1 − 2ν) g(Dt/a², s/a) dt [s]."""
        still, grows, tensed, both = np.array(_MEANS[self.surface])
        wider, half = _WIDENS[self.surface]
        flowed = self.diffusivity * time
        # A contact of no size has drained.
        squared = np.maximum((radius + wider * length) ** 2, _DRAINED * flowed)
        root = np.sqrt(flowed / np.maximum(squared, 1e-300))
        ratio = self.drained_ratio / (1 - self.drained_ratio)
        part = length / np.maximum(length + half * radius, 1e-300)
        b1, b2, c1, c2, c3 = (
            s + g * ratio + (t + b * ratio) * part
            for s, g, t, b in zip(still, grows, tensed, both, strict=True)
        )
        mean = (1 + root * (b1 + root * b2)) / (1 + root * (c1 + root * (c2 + root * c3)))
        return np.asarray(time * (1 + (1 - 2 * self.drained_ratio) * mean))
