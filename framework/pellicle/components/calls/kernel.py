"""Calls of a kernel that relaxes: its branches and its instantaneous response."""

from __future__ import annotations

import math

from pellicle.checks import component_name, errors_attributed_to, real_number
from pellicle.components.kernel import Kernel
from pellicle.contact.time_step import Branch
from pellicle.errors import PluginError, shown

# Rounding error of a sum of shares.
_ROUNDING = 1e-12


def branches_of(kernel: Kernel) -> tuple[Branch, ...]:
    """Return the branches of a kernel that relaxes; none of one that is elastic."""
    with errors_attributed_to(kernel):
        value = kernel.branches()
        if not value:
            return ()
        value = tuple(Branch(*branch) for branch in value)
    branches = tuple(
        Branch(*(real_number(kernel, f"branches() {name}", v) for name, v in b._asdict().items()))
        for b in value
    )
    total = math.fsum(branch.share for branch in branches)
    if not all(b.share > 0 and 0 < b.time < math.inf for b in branches) or total > 1 + _ROUNDING:
        raise PluginError(
            f"{component_name(kernel)}: branches() returned {shown(branches)}; shares and times "
            "have to be positive and finite, and the shares sum to at most 1"
        )
    return branches


def instantaneous(kernel: Kernel) -> Kernel:
    """Return the elastic kernel of the instantaneous response; an elastic kernel itself.

    It may have a closed form, which a kernel that relaxes need not have.
    """
    return kernel.scaled(1.0) if branches_of(kernel) else kernel
