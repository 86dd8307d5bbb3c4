"""The sum of several indenters."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import Footprint, FromRegistry, Indenter
from pellicle.errors import ConfigError

from .transformed import profile_of_part


class Sum(Indenter):
    """Heights of several indenters added, such as roughness on a sphere.

    It ends at the edge of the domain if any of its parts does. Depth is measured from the lowest
    point of the sum, not of its parts.
    """

    type: Literal["sum"] = "sum"
    examples = (
        {
            "parts": [
                {"type": "sphere", "radius": "1 mm"},
                {"type": "quadric", "radius_x": "2 mm", "radius_y": "4 mm"},
            ]
        },
    )
    parts: Annotated[
        tuple[Annotated[Indenter, FromRegistry()], ...],
        Field(
            min_length=1,
            examples=[
                [
                    {"type": "paraboloid", "radius": "1 mm"},
                    {"type": "cone", "half_angle": "85 degree"},
                ]
            ],
            description="the indenters to add: tables with type",
        ),
    ]

    @property
    def footprint(self) -> Footprint:
        """``"domain"`` if any part ends there."""
        return "domain" if any(part.footprint == "domain" for part in self.parts) else "unbounded"

    def profile(self, x: Array, y: Array) -> Array:
        """Return Σ f_i − its value at the lowest point [m].

        The lowest point of the sum of the unbounded parts is located between the cells. Parts that
        end with the domain are known at the cells only: the distance of their highest cell from 0
        is taken as that of the highest cell of the sum, correct to second order in the spacing.
        """
        shape = np.broadcast_shapes(x.shape, y.shape)
        smooth, rough = np.zeros(shape), np.zeros(shape)
        hidden = 0.0
        for index, part in enumerate(self.parts):
            profile = profile_of_part(part, x, y, f"parts.{index}")
            if part.footprint == "domain":
                rough += profile
                hidden -= float(profile.max())
            else:
                smooth += profile
        total = smooth + rough
        at = np.unravel_index(np.argmax(total), shape)
        top = float(total[at])
        if not np.isfinite(top):
            raise ConfigError("do not overlap anywhere; shift them so that they do", "parts")
        hidden += self._summit(x, y, smooth) - float(smooth.max())
        # Rounding may leave the lowest point slightly above 0.
        return np.minimum(total - (top + hidden), 0.0)

    def _summit(self, x: Array, y: Array, smooth: Array) -> float:
        """Return the maximum of the sum of the unbounded parts, at cells or between them."""
        from scipy.optimize import minimize

        unbounded = [part for part in self.parts if part.footprint == "unbounded"]

        def heights(px: float, py: float) -> float:
            point = np.array([[px]]), np.array([[py]])
            return float(sum(part.profile(*point).item() for part in unbounded))

        # No part is above 0, so a sum of 0 at the centre is the maximum.
        if heights(0.0, 0.0) == 0:
            return 0.0
        i, j = np.unravel_index(np.argmax(smooth), smooth.shape)
        xs, ys = np.broadcast_arrays(x, y)
        start = np.array([xs[i, j], ys[i, j]])
        length, height = np.ptp(xs) + np.ptp(ys), -float(smooth[i, j])
        if height == 0:
            return 0.0
        summit = minimize(
            lambda shift: -heights(*(start + shift * length)) / height,
            np.zeros(2),
            method="Nelder-Mead",
            options={"xatol": 1e-13, "fatol": 1e-15, "initial_simplex": _SIMPLEX},
        )
        if not summit.success:
            raise ConfigError(f"have no lowest point that can be found ({summit.message})", "parts")
        return -float(summit.fun) * height


_SIMPLEX = 0.01 * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
"""Initial simplex of the search for the lowest point, relative to the domain."""
