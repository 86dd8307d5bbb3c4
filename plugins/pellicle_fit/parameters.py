"""Parameters of fits: those that every curve has, and those of a solid under tension."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Parameter:
    """A quantity that a fit determines, or that the user fixes."""

    name: str
    unit: str
    """SI unit; if not `logarithmic`, one of those that `Likelihood.ranges` scales."""
    minimum: float = -np.inf
    """Least allowed value, which the best value may equal."""
    maximum: float = np.inf
    """Greatest allowed value."""
    logarithmic: bool = False
    """Whether the fit varies the natural logarithm, as for a modulus of unknown magnitude."""
    shared: bool = False
    """Whether all curves of a pooled fit have the same value."""
    plausible: tuple[float, float] = (-np.inf, np.inf)
    """Range beyond which a unit is probably wrong."""
    curve: int = 0
    """Index of the curve in a pooled fit; 0 if shared."""

    @property
    def word(self) -> str:
        """The last word of the name, for sentences."""
        return self.name.rpartition("_")[2]

    @property
    def is_length(self) -> bool:
        """Whether it varies as a logarithm between limits that the range of positions sets."""
        return self.logarithmic and self.unit == "m"

    def of_curve(self, index: int) -> Parameter:
        """Return the parameter of one curve of a pooled fit."""
        return self if self.shared else replace(self, curve=index)

    def coordinate(self, value: float) -> float:
        """Return the coordinate that the fit varies: the value, or its natural logarithm."""
        return float(np.log(value)) if self.logarithmic else value

    def value(self, coordinate: float) -> float:
        """Return the value at a coordinate."""
        return float(np.exp(coordinate)) if self.logarithmic else coordinate


Values = Mapping[Parameter, float]
"""Values of parameters, each in its unit."""
Coordinates = dict[Parameter, float]
"""Values that a fit varies: of each parameter, or its natural logarithm if `logarithmic`."""

CONTACT_POINT = Parameter("contact_point", "m")
"""Position of first touch."""
MODULUS = Parameter("reduced_modulus", "Pa", logarithmic=True, shared=True, plausible=(1.0, 1e12))
"""E*."""
TENSION = Parameter("tension", "N/m", minimum=0.0, shared=True, plausible=(0.0, 1.0))
"""τ₀."""
THICKNESS = Parameter("thickness", "m", logarithmic=True, shared=True, plausible=(1e-9, 1.0))
"""h of a layer."""
OFFSET = Parameter("offset", "N")
"""Force of the baseline at the first position."""
SLOPE = Parameter("slope", "N/m")
"""Slope of the baseline."""
