"""What to do next with a curve: mend how it is read, fit it otherwise, or measure more."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pellicle_fit.estimation.candidate import Candidate
from pellicle_fit.estimation.coordinates import CONTACT_POINT
from pellicle_fit.estimation.noise import FEWEST, Flaw

from .forecast import telling_measurement
from .recipe import DRAINING, Answer
from .verdict import Verdict

if TYPE_CHECKING:
    from pellicle_fit.config import FitConfig

PLAUSIBLE = {"reduced_modulus": (1.0, 1e12), "tension": (0.0, 1.0), "thickness": (1e-9, 1.0)}
"""Values [SI] beyond which a unit is probably wrong."""
_DEPTHS = 1e-5, 10.0
"""Depths over the radius beyond which a unit is probably wrong."""


class Remedy(Enum):
    """What may be done; behind it what is known of it."""

    CHECK_RADIUS = "check_radius"
    """depth, radius [m]"""
    BEGIN_EARLIER = "begin_earlier"
    """rows before contact"""
    CHECK_UNITS = "check_units"
    """name, value, unit of a quantity"""
    FIT_SLOPE = "fit_slope"
    FIT_OFFSET = "fit_offset"
    ASK_ADHESION = "ask_adhesion"
    DELETE_SPIKES = "delete_spikes"
    FIT_BOTH = "fit_both"
    """first and last row of the retraction"""
    GIVE_THICKNESS = "give_thickness"
    """needs_ratio: whether Poisson's ratio is not known"""
    FIT_APPROACH = "fit_approach"
    MEASURE = "measure"
    """proposal, and how many curves"""
    LESS_NOISE = "less_noise"


class Advice(NamedTuple):
    """Something to do."""

    remedy: Remedy
    values: Mapping[str, Any] = {}
    """Numbers in SI and names that it rests on."""


def advise(
    answer: Answer, left_out: tuple[int, int] | None, config: FitConfig
) -> tuple[Advice, ...]:
    """Return what to do next, the most urgent first: mend the fit, else measure; or nothing.

    First and last row are those of a retraction that was ``left_out``.
    """
    first = *_of_input(answer), *_of_options(answer, left_out, config)
    if first:
        return first
    if answer.verdict is Verdict.CANNOT_TELL:
        return (_measurement(answer.target, answer.tied_without) or Advice(Remedy.LESS_NOISE),)
    drains = [fit for fit in answer.tied if DRAINING in fit.types]
    flows = [fit for fit in answer.tied if fit not in drains]
    found = _measurement(drains[0], flows) if drains and flows else None
    return (found,) if found else ()


def _of_input(answer: Answer) -> Iterator[Advice]:
    """Yield what is probably wrong with radius or units."""
    selected = answer.selected
    depths = selected.depths
    for curve, of_rows in zip(selected.all_rows, depths, strict=True):
        radius, depth = getattr(curve.indenter, "radius", None), float(np.max(of_rows))
        if radius and not _DEPTHS[0] <= depth / radius <= _DEPTHS[1]:
            yield Advice(Remedy.CHECK_RADIUS, {"depth": depth, "radius": radius})
            break
    few = [int(count) for of_rows in depths if (count := np.sum(of_rows < 0)) < FEWEST]
    if CONTACT_POINT in selected.estimates and few:
        yield Advice(Remedy.BEGIN_EARLIER, {"rows": few[0]})
    for name, (least, most) in PLAUSIBLE.items():
        if (estimate := answer.selected.estimates.get(name)) is None:
            continue
        # The best value of an open interval is one of many.
        low, high = estimate.low or 0.0, np.inf if estimate.high is None else estimate.high
        if low > most or high < least:
            known = {"name": name, "value": estimate.value, "unit": estimate.unit}
            yield Advice(Remedy.CHECK_UNITS, known)


def _of_options(
    answer: Answer, left_out: tuple[int, int] | None, config: FitConfig
) -> Iterator[Advice]:
    """Yield what another option of the fit would mend."""
    flaws = {flaw for judgement in answer.judgements for flaw in judgement.flaws}
    types = answer.selected.types
    undescribed = answer.verdict is Verdict.UNDESCRIBED
    if (Flaw.DRIFT in flaws or "slope" in types) and config.baseline != "slope":
        yield Advice(Remedy.FIT_SLOPE)
    elif (Flaw.OFFSET in flaws or "offset" in types) and config.baseline == "none":
        yield Advice(Remedy.FIT_OFFSET)
    if Flaw.DIP in flaws and not {"adhesion"} & types.union(*answer.excused):
        yield Advice(Remedy.ASK_ADHESION)
    if Flaw.SPIKES in flaws:
        yield Advice(Remedy.DELETE_SPIKES)
    if answer.verdict is Verdict.CANNOT_TELL and left_out:
        yield Advice(Remedy.FIT_BOTH, {"first": left_out[0], "last": left_out[1]})
    is_layer = not undescribed and any("layer" in fit.types for fit in answer.tied)
    if config.thickness is None and is_layer:
        yield Advice(Remedy.GIVE_THICKNESS, {"needs_ratio": config.poissons_ratio is None})
    if answer.untried and undescribed:
        yield Advice(Remedy.FIT_APPROACH)


def _measurement(target: Candidate, others: Sequence[Candidate]) -> Advice | None:
    """Return what to measure, so that explanations can be told apart; None if nothing would do."""
    proposal, curves = telling_measurement(target, others)
    known = {"proposal": proposal, "curves": curves}
    return Advice(Remedy.MEASURE, known) if proposal else None
