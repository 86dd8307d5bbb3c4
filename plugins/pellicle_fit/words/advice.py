"""What to do next with a curve, and why, in words."""

from __future__ import annotations

from typing import NamedTuple

from pellicle.units import readable
from pellicle_fit.selection.advice import Advice, Remedy
from pellicle_fit.selection.forecast import Means, Proposal

from .names import words

_PLAIN = {
    Remedy.FIT_SLOPE: ("add --baseline slope", "the force before contact has a slope"),
    Remedy.FIT_OFFSET: ("add --baseline offset", "the force before contact is not 0"),
    Remedy.ASK_ADHESION: ("ask with --model adhesion", "the force dips before contact"),
    Remedy.DELETE_SPIKES: (
        "look at single outlying rows, and delete faulty ones",
        "single points lie far from their neighbours, and shift the fit",
    ),
    Remedy.FIT_APPROACH: (
        "fit with --segment approach",
        "tension with relaxation can be fitted to an approach alone",
    ),
    Remedy.LESS_NOISE: (
        "measure with less noise",
        "no other speed, dwell, pass, depth or radius would tell them apart",
    ),
}
"""What to do, and why, where no number is told."""


class Step(NamedTuple):
    """Something to do, and why."""

    do: str
    why: str
    kind: str
    """A code of what is to be done, without its numbers."""


def step(advice: Advice) -> Step:
    """Return an advice in words."""
    remedy, known = advice
    kind = remedy.value
    match remedy:
        case Remedy.CHECK_RADIUS:
            depth, radius = known["depth"], known["radius"]
            sizes = readable(depth, "m", 3), f"{depth / radius:.3g}", readable(radius, "m", 3)
            why = "the depth of {} is {} times the radius of {}".format(*sizes)
            return Step("check radius and units", why, kind)
        case Remedy.BEGIN_EARLIER:
            why = (
                f"only {known['rows']} rows lie before it, so that no check can contradict the fit"
            )
            return Step("begin curves before contact", why, kind)
        case Remedy.CHECK_UNITS:
            value = readable(known["value"], known["unit"], 3)
            return Step(
                "check the units", f"a {words(known['name'])} of {value} is not plausible", kind
            )
        case Remedy.FIT_BOTH:
            why = f"rows {known['first']} to {known['last']}, the retraction, may tell them apart"
            return Step("fit with --segment both", why, kind)
        case Remedy.GIVE_THICKNESS:
            ratio = "--poissons-ratio and " if known["needs_ratio"] else ""
            do = f"if the sample is thin, give {ratio}--thickness (a length, or free)"
            return Step(do, "a layer on a rigid base describes the curve", kind)
        case Remedy.MEASURE:
            proposal, count = known["proposal"], known["curves"]
            curves = f"{count} curves of this kind" if count > 1 else "it"
            why = f"{curves} would tell these explanations apart"
            return Step(f"measure {_proposed(proposal)}", why, f"{kind}_{proposal.means.value}")
    return Step(*_PLAIN[remedy], kind)


def _proposed(proposal: Proposal) -> str:
    """Return a measurement in words."""
    means, value = proposal
    match means:
        case Means.RETRACTION:
            return "the retraction"
        case Means.DWELL:
            return f"a dwell of {readable(value, 's', 2)} at the largest depth"
        case Means.SPEED:
            return f"a second speed of {readable(value, 'm/s', 2)}"
        case Means.SHALLOWER | Means.DEEPER:
            return f"a {means.value} curve, to a depth of {readable(value, 'm', 2)}"
        case Means.RADIUS:
            return f"a second radius, {readable(value, 'm', 2)}"
