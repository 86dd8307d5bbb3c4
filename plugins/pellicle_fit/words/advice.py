"""What to do next with a curve: mend how it is read, fit it otherwise, or measure more."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pellicle.units import readable
from pellicle_fit.forecast import telling
from pellicle_fit.noise import FEWEST, Flaw
from pellicle_fit.objective import CONTACT_POINT
from pellicle_fit.recipe import Answer
from pellicle_fit.verdict import Verdict

from .names import PLAUSIBLE, words

if TYPE_CHECKING:
    from pellicle_fit.config import FitConfig
    from pellicle_fit.result import Member

_DEPTHS = 1e-5, 10.0
"""Depths over the radius beyond which a unit is probably wrong."""


class Step(NamedTuple):
    """Something to do, and why."""

    do: str
    why: str


def steps(answer: Answer, members: Sequence[Member], config: FitConfig) -> list[Step]:
    """Return what to do next, the most urgent first: mend the fit, else measure; or nothing."""
    first = [*_of_input(answer), *_of_options(answer, members, config)]
    is_open = answer.verdict is Verdict.CANNOT_TELL
    return [_measurement(answer)] if is_open and not first else first


def _of_input(answer: Answer) -> Iterator[Step]:
    """Yield what is probably wrong with radius or units."""
    chosen = answer.chosen
    depths = chosen.depths
    for curve, of_rows in zip(chosen.whole, depths, strict=True):
        radius, depth = getattr(curve.indenter, "radius", None), float(np.max(of_rows))
        if radius and not _DEPTHS[0] <= depth / radius <= _DEPTHS[1]:
            sizes = readable(depth, "m", 3), f"{depth / radius:.3g}", readable(radius, "m", 3)
            why = "the depth of {} is {} times the radius of {}".format(*sizes)
            yield Step("check radius and units", why)
            break
    few = [count for of_rows in depths if (count := np.sum(of_rows < 0)) < FEWEST]
    if CONTACT_POINT in chosen.estimates and few:
        why = f"only {few[0]} rows lie before it, so that no check can contradict the fit"
        yield Step("begin curves before contact", why)
    for name, (least, most) in PLAUSIBLE.items():
        if (found := answer.chosen.estimates.get(name)) is None:
            continue
        # The best value of an open interval is one of many.
        low, high = found.low or 0.0, np.inf if found.high is None else found.high
        if low > most or high < least:
            value = readable(found.value, found.unit, 3)
            yield Step("check the units", f"a {words(name)} of {value} is not plausible")


def _of_options(answer: Answer, members: Sequence[Member], config: FitConfig) -> Iterator[Step]:
    """Yield what another option of the fit would mend."""
    flaws = {flaw for one in answer.judgements for flaw in one.flaws}
    types = answer.chosen.objective.explanation.types
    if (Flaw.DRIFT in flaws or "slope" in types) and config.baseline != "slope":
        yield Step("add --baseline slope", "the force before contact has a slope")
    elif (Flaw.OFFSET in flaws or "offset" in types) and config.baseline == "none":
        yield Step("add --baseline offset", "the force before contact is not 0")
    if Flaw.DIP in flaws and not {"adhesion"} & types.union(*answer.excused):
        yield Step("ask with --model adhesion", "the force dips before contact")
    if Flaw.SPIKES in flaws:
        why = "single points lie far from their neighbours, and shift the fit"
        yield Step("look at single outlying rows, and delete faulty ones", why)
    rows = next((one for member in members if (one := member.measured.left_out)), None)
    if answer.verdict is Verdict.CANNOT_TELL and rows:
        why = f"rows {rows[0]} to {rows[1]}, the retraction, may tell them apart"
        yield Step("fit with --segment both", why)
    if config.thickness is None and any("layer" in fit.types for fit in answer.tied):
        why = "a layer on a rigid base describes the curve"
        ratio = "" if config.poissons_ratio is not None else "--poissons-ratio and "
        yield Step(f"if the sample is thin, give {ratio}--thickness (a length, or free)", why)
    if answer.untried and answer.verdict is Verdict.UNDESCRIBED:
        why = "tension with relaxation can be fitted to an approach alone"
        yield Step("fit with --segment approach", why)


def _measurement(answer: Answer) -> Step:
    """Return what to measure, so that explanations can be told apart."""
    measure, count = telling(answer.asked, answer.tied_without)
    if not measure:
        why = "no other speed, dwell, pass, depth or radius would tell them apart"
        return Step("measure with less noise", why)
    curves = f"{count} curves of this kind" if count > 1 else "it"
    return Step(f"measure {measure}", f"{curves} would tell these explanations apart")
