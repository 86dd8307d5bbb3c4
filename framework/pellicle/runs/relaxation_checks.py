"""Whether the steps and the domain of a run suit a solid that relaxes."""

from __future__ import annotations

import math
import warnings
from typing import Final

import numpy as np

from pellicle.components.kernel import branches_of
from pellicle.config.run import Run
from pellicle.contact.skin_operators import CarriedShare
from pellicle.contact.time_step import stiffness_after

# Softest solid, over its instantaneous stiffness, and longest wave, over a third of the domain,
# that are told from a liquid.
_SOFTEST: Final = 1e-9
_LONGEST: Final = 1e9
# Largest stiffness in the end, over the instantaneous one, of a liquid; it is rounding.
_LIQUID: Final = 1e-12
# Relaxation times below this share of the shortest step are far below it.
_FAST: Final = 0.01
# 8 radii of a contact, to each of which its counted cells may add a hundredth.
_RADII: Final = 7.9


def warn_of_relaxation(run: Run) -> None:
    """Warn if a solid relaxes to a liquid, or far faster than the steps of its run.

    A kernel that states its time span has a share of its own for all times beyond.
    """
    kernel, branches = run.kernel, branches_of(run.kernel)
    if not branches:
        return
    shortest, longest = kernel.time_span()
    if longest == math.inf and stiffness_after(branches, math.inf) < _LIQUID:
        warnings.warn(
            f"kernel: the shares of {kernel.type_name!r} that relax sum to 1, which makes the "
            "solid a liquid: in the end only a skin carries; let them sum to less for a solid",
            stacklevel=3,
        )
    least = min((duration for duration in run.loading.durations if duration > 0), default=0.0)
    fastest = min(branch.time for branch in branches)
    if shortest == 0.0 and fastest < _FAST * least:
        warnings.warn(
            f"loading: the shortest step takes {least:g} s, far longer than the relaxation time "
            f"{fastest:g} s of a share of the solid, so that how this share relaxes is not seen; "
            "use shorter steps where it matters, or a softer solid without the share",
            stacklevel=3,
        )


def least_domain(run: Run, index: int, largest_area: float) -> float:
    """Return the edge [m] that a domain needs at a step, for what its solid carries outside.

    It is 8 radii of the largest contact so far, since a solid remembers a contact that has shrunk,
    or 7.9 of those that the cells of ``largest_area`` [m²] count; and 3 times the length 1/q of the
    wave for which the skin is as stiff as the solid is after the duration of the run so far: 2τ₀/E*
    under a tension. It is 0 where there is nothing outside: at the first step, without a skin, and
    on a periodic boundary.
    """
    kernel, branches = run.kernel, branches_of(run.kernel)
    if not index or not branches or run.grid.boundary == "periodic":
        return 0.0
    solid = kernel.without_skin()
    if solid == kernel:
        return 0.0
    elapsed = math.fsum(run.loading.durations[: index + 1])
    share = max(_SOFTEST, stiffness_after(branches, elapsed))
    carried = CarriedShare(kernel.scaled(share), solid)
    shortest = 3 / min(run.grid.size)
    radius = math.sqrt(largest_area / math.pi)
    length = 0.0
    if share * carried.compliance(np.array([shortest])).item() < 0.5:
        waves = shortest * np.geomspace(1 / _LONGEST, 1.0, 1 + 20 * round(math.log10(_LONGEST)))
        stiff = np.flatnonzero(share * carried.compliance(waves) >= 0.5)
        length = 1 / float(waves[stiff[-1]]) if stiff.size else math.inf
    return max(_RADII * radius, 3 * length)
