"""The width of the zone around a contact in which an interaction pulls."""

from __future__ import annotations

import numpy as np

from pellicle.components import Kernel

# q times the width of the zone of `softening_strength`. The gap in the zone is a wave for which
# 1/G(q) = dσ/dg. A quarter of it, π/2, fits on a membrane; 1.27 was measured on a half-space.
_PHASE = 1.4


def softening_strength(work_of_adhesion: float, width: float, kernel: Kernel) -> float:
    """Return the strength [Pa] of linear softening whose zone is about ``width`` [m] wide.

    The traction −σ₀(1 − g/g_max), with g_max = 2w/σ₀, has the slope σ₀²/(2w), which the stiffness
    1/G(q) of the zone's own wave balances.
    """
    compliance = float(kernel.compliance(np.array([_PHASE / width]))[0])
    return float(np.sqrt(2 * work_of_adhesion / compliance))


def zone_width(work_of_adhesion: float, strength: float, kernel: Kernel, cell: float) -> float:
    """Return the approximate width [m] of the zone of a law with ``strength`` [Pa].

    It is the width for which `softening_strength` gives this strength, between 10⁻³ and 10⁶ times
    the width of a ``cell`` [m].
    """
    from scipy.optimize import brentq

    def excess(log_width: float) -> float:
        return float(
            np.log(softening_strength(work_of_adhesion, np.exp(log_width), kernel) / strength)
        )

    low, high = np.log(1e-3 * cell), np.log(1e6 * cell)
    if excess(low) < 0:
        return float(np.exp(low))
    if excess(high) > 0:
        return float(np.exp(high))
    return float(np.exp(brentq(excess, low, high, xtol=1e-3)))
