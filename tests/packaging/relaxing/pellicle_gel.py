"""Kernels for pellicle: a gel that relaxes in two equal parts, and a sponge that drains."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

import pellicle as pl
from pellicle.components import Branch
from pellicle.units import Modulus, Quantity, Time


class Gel(pl.Isotropic):
    """Half-space of which 80 % relaxes."""

    type: Literal["gel"] = "gel"
    reduced_modulus: Annotated[Modulus, Field(description="instantaneous modulus E* [Pa]")]
    time: Annotated[Time, Field(description="shorter relaxation time [s]")]

    def compliance(self, q):
        """Return the instantaneous G(q) = 2/(E* q) [m/Pa]."""
        return 2 / (self.reduced_modulus * q)

    def branches(self):
        """Return shares of the instantaneous stiffness with their times [s]."""
        return (Branch(0.4, self.time), Branch(0.4, 10 * self.time))

    def scaled(self, share):
        """Return an elastic half-space, this one times ``share``."""
        return pl.kernel("half_space", reduced_modulus=share * self.reduced_modulus)

    def without_skin(self):
        """Return this kernel, which has no skin."""
        return self


class Sponge(pl.Isotropic):
    """Half-space of which 40 % relaxes as its liquid leaves, long waves last."""

    type: Literal["sponge"] = "sponge"
    reduced_modulus: Annotated[Modulus, Field(description="instantaneous modulus E* [Pa]")]
    diffusivity: Annotated[float, Quantity("m2/s", above=0)] = Field(description="D [m²/s]")

    def compliance(self, q):
        """Return the instantaneous G(q) = 2/(E* q) [m/Pa]."""
        return 2 / (self.reduced_modulus * q)

    def branches(self):
        """Return a share with its time 1/(D q²) [s]."""
        return (Branch(0.4, lambda q: 1 / (self.diffusivity * np.maximum(q, 1e-9) ** 2)),)
