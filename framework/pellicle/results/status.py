"""The statuses of load steps."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import Final

# Between the caveats in the message of a step.
_AND: Final = "; moreover, "


class Status(Enum):
    """The outcome of a load step; the value is the message to the user.

    `NOT_RUN` and `FAILED` occur in the table of a study only.
    """

    CONVERGED = "converged"
    NEAREST_AREA = (
        "converged; the contact area misses the prescribed one by {measure:.1e}: it jumps from "
        "{below} to {above}, and no load attains a nearer number of whole cells; use more points"
    )
    NEAREST = (
        "converged; the {quantity} misses the prescribed one by {measure:.1e}: it jumps from "
        "{below} to {above}"
    )
    COARSE = (
        "converged, but the cells are too coarse for this contact, which covers {cells} of them, "
        "{width} wide: force, depth and area may be far off; use more points, or a smaller "
        "grid.size"
    )
    COARSE_ZONE = (
        "converged, but the zone in which the interaction pulls is {cells:.1f} cells wide, where "
        "it takes {least:g} for the contact not to be pinned by the cells: force and area may be "
        "off; use more points, or a longer range"
    )
    STEEP = (
        "converged, but slopes in contact reach {slope:.2f}, and the theory is for slopes up to "
        "{most:g}: force and area are those of the model, not of the experiment"
    )
    SMALL_DOMAIN = (
        "converged, but the domain of {size} is small for a skin on a solid that relaxes: what the "
        "solid carries beyond it is known in sum only, and force and depth may be off by per cent; "
        "{remedy}"
    )
    JUMPED = (
        "converged; a part of the contact jumped after the last step{loss}: in between it "
        "is not in equilibrium; smaller steps show where it jumps"
    )
    NOT_FINITE = (
        "the pressure became NaN or infinite; check the kernel's compliance and the profile for "
        "extreme values"
    )
    NEGATIVE_PRESSURE = "the solver returned a negative pressure, {measure:.1e} of the highest"
    CONTACT_RESIDUAL = (
        "the surface misses the indenter inside the contact by {measure:.1e} of the indenter's "
        "height range there, over the tolerance {tolerance:.1e}; {remedy}"
    )
    PENETRATION = (
        "the surface penetrates the indenter outside the contact by {measure:.1e} of the height "
        "range in contact, over the tolerance {tolerance:.1e}; {remedy}"
    )
    COMPLEMENTARITY = (
        "pressure acts across a gap: complementarity {measure:.1e} is over the tolerance "
        "{tolerance:.1e}; {remedy}"
    )
    LOAD = "the force misses the prescribed one by {measure:.1e}, over {tolerance:.1e}; {remedy}"
    AREA = (
        "the contact area misses the prescribed one by {measure:.1e}, over {tolerance:g}; {remedy}"
    )
    NOT_REACHED = (
        "the {quantity} misses the prescribed one by {measure:.1e}, over {tolerance:g}; {remedy}"
    )
    TRACTION = (
        "the traction across the gap misses that of the interaction by {measure:.1e}, over the "
        "tolerance {tolerance:.1e}; {remedy}"
    )
    PULLED_OFF = (
        "no contact carries a force of {force}: that of the step before is lost between "
        "{carried} and {lost}; a softer holder follows it further: prescribe depth, or "
        "base_displacement with a spring_constant"
    )
    NOTHING_TO_PULL = (
        "there is no contact that could carry a force of {force}; press before you pull"
    )
    STIFFNESS = (
        "the contact stiffness is not known: its displacement misses by {measure:.1e}, over the "
        "tolerance {tolerance:.1e}; loosen solver.tolerance, or leave loading.stiffness out"
    )
    CONTACT_AT_EDGE = (
        "the contact reaches the edge of the domain, where the indenter does not end, so force "
        "and area are wrong; enlarge grid.size = {size} or press in less far ({prescribed})"
    )

    NOT_RUN = "not run"
    FAILED = "failed: {reason}"

    @property
    def converged(self) -> bool:
        """Whether the numbers of the step may be used, possibly with a caveat."""
        return self in (
            Status.CONVERGED,
            Status.NEAREST_AREA,
            Status.NEAREST,
            Status.COARSE,
            Status.COARSE_ZONE,
            Status.STEEP,
            Status.JUMPED,
            Status.SMALL_DOMAIN,
        )

    @property
    def verdict(self) -> str:
        """The status in one or two words, for tables."""
        if self.converged:
            return "converged"
        return {Status.NOT_RUN: "not run", Status.FAILED: "failed"}.get(self, "NOT CONVERGED")


def with_caveats(messages: Sequence[str]) -> str:
    """Return the message of a step that has several statuses, most important first."""
    first, *others = messages
    return _AND.join([first, *(_parted(message)[1] for message in others)])


def statuses_of(code: str, message: str) -> list[tuple[Status, str]]:
    """Return each status in the code and message of a step, with a message of its own."""
    first = Status[code]
    head, *rest = message.split(_AND) if first.converged else [message]
    statuses = [(first, head)]
    for text in rest:
        named = [s for s in Status if s.converged and text.startswith(_beginning(s))]
        # "the" alone begins the message of several.
        status = max(named, key=lambda s: len(_beginning(s)))
        statuses.append((status, f"{_parted(status.value)[0]}{text}"))
    return statuses


def _parted(message: str) -> tuple[str, str]:
    """Return the beginning of a caveat that says that the step converged, and what follows it."""
    prefix = next((p for p in ("converged, but ", "converged; ") if message.startswith(p)), "")
    return prefix, message.removeprefix(prefix)


def _beginning(status: Status) -> str:
    """Return what the message of a status begins with, without the prefix."""
    return _parted(status.value)[1].partition("{")[0]
