"""Experiments that would be more informative: Cramér–Rao bounds at other radii and ranges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from pellicle.units import decimal, readable
from pellicle_fit.models.force_model import ClosedFormModel
from pellicle_fit.models.layer import FreeLayerModel, LayerModel, with_thickness
from pellicle_fit.parameters import CONTACT_POINT, MODULUS, TENSION, Coordinates

from .likelihood import Likelihood
from .profile import Estimate

_FACTORS = (1 / 10, 1 / 3, 3.0, 10.0)
_DEEPEST = 0.5
"""Largest depth over radius that is recommended, roughly the limit of linear elasticity."""
_USELESS = 10.0
"""Relative standard deviation beyond which an experiment is not informative."""
_GAIN = 1.3
"""Least factor by which a recommended experiment has a smaller bound."""


class _Design(NamedTuple):
    """An experiment, and its Cramér–Rao bounds as relative standard deviations."""

    words: str
    modulus: float
    tension: float

    @property
    def worse(self) -> float:
        """The greater of the two bounds."""
        return max(self.modulus, self.tension)


def advice(
    likelihood: Likelihood, parameters: Coordinates, modulus: Estimate, tension: Estimate
) -> tuple[str, list[str]]:
    """Return the bounds of modulus and tension, which experiment would tighten them, and warnings.

    Both are empty if one of the two is fixed.  If the curve shows no tension, the bounds are those
    at a tension that it could just miss.  The warning says why an interval is open.
    """
    if modulus.held or tension.held:
        return "", []
    with_tension = _with_tension(likelihood, parameters, tension)
    now, others = _designs(likelihood, with_tension)
    if tension.value and not np.isfinite([modulus.bound, tension.bound]).all():
        words = (
            "the force is so far from linear in modulus and tension that no bound (Cramér–Rao) of "
            "their errors holds; the intervals do"
        )
    else:
        condition = f"for a tension of {readable(with_tension[TENSION], 'N/m', 2)}: "
        shares = {"modulus": now.modulus, "tension": now.tension}
        words = (
            f"{condition if with_tension[TENSION] != tension.value else ''}"
            f"{_bounds('this curve', shares)}; {_better(now, others)}"
        )
    if not _is_open(modulus, tension):
        return words, []
    is_modulus = modulus.low is None or modulus.high is None
    name, undecided = ("modulus", modulus) if is_modulus else ("tension", tension)
    end = f" (it is {undecided.only_end})" if undecided.only_end else ""
    warning = (
        f"the curve cannot tell modulus and tension apart: the interval of the {name} is open"
        f"{end}, and its value is one of many"
    )
    if min(design.worse for design in (now, *others)) < _USELESS:
        length = 2 * tension.value / modulus.value
        shallow = length > likelihood.deepest(parameters)
        warning += f"; the curve is too {'shallow' if shallow else 'deep'}"
    return words, [warning]


def _better(now: _Design, others: Sequence[_Design]) -> str:
    """Return which experiment would be more informative."""
    if min(design.worse for design in (now, *others)) >= _USELESS:
        return (
            "with this indenter no other radius or range would tell them apart: fix one of them, "
            "or press with another shape"
        )
    if not others or not others[0].worse * _GAIN < now.worse:
        return "more points or less noise would help, another radius or range hardly"
    best = others[0]
    return (
        f"{best.words} at the same noise relative to the largest force would bring "
        f"± {_percent(best.modulus)} and ± {_percent(best.tension)}"
    )


def pooled_advice(modulus: Estimate, tension: Estimate) -> tuple[str, list[str]]:
    """Return the bounds of shared parameters, and a warning if an interval is open."""
    shares = {
        name: estimate.bound / estimate.value
        for name, estimate in (("modulus", modulus), ("tension", tension))
        if not estimate.held and estimate.value and np.isfinite(estimate.bound)
    }
    words = _bounds("these curves", shares) if shares else ""
    if not _is_open(modulus, tension):
        return words, []
    return words, [
        "the curves together cannot tell modulus and tension apart: an interval is open, and its "
        "value is one of many; add curves of another radius or range"
    ]


def _is_open(modulus: Estimate, tension: Estimate) -> bool:
    """Return whether both are fitted, and one has an interval that does not end."""
    fixed = modulus.held or tension.held
    return not fixed and None in (modulus.low, modulus.high, tension.high)


def _bounds(subject: str, shares: Mapping[str, float]) -> str:
    """Return relative Cramér–Rao bounds by the name of the parameter in words."""
    bounds = [f"± {_percent(share)} of the {name}" for name, share in shares.items()]
    return (
        f"no unbiased fit of {subject} could beat {' and '.join(bounds)} (Cramér–Rao bound, one "
        "standard deviation)"
    )


def _percent(share: float) -> str:
    return f"{decimal(100 * share, 2)} %" if share < 10 else "more than 1000 %"


def _designs(likelihood: Likelihood, parameters: Coordinates) -> tuple[_Design, list[_Design]]:
    """Return this experiment and others, best first.

    The others have the same number of points, the same share of them before contact, and the same
    noise relative to the largest force.
    """
    now = _design("this curve", likelihood, parameters)
    deepest = likelihood.deepest(parameters)
    model: Any = likelihood.force_model
    has_shape = isinstance(model, (ClosedFormModel, LayerModel, FreeLayerModel))
    indenter: Any = model.indenter if has_shape else None
    radius = getattr(indenter, "radius", None)
    others: dict[str, Likelihood] = {}
    for factor in _FACTORS:
        within = factor * deepest <= with_thickness(model, parameters).depth_limit
        if within and (radius is None or factor * deepest <= _DEEPEST * radius):
            kind = "deeper" if factor > 1 else "shallower"
            position = parameters[CONTACT_POINT] + factor * likelihood.depth(parameters)
            other = replace(likelihood, position=position)
            others[f"a {kind} range, to {_metres(factor * deepest)},"] = other
        if radius is not None and deepest <= _DEEPEST * factor * radius:
            kind = "larger" if factor > 1 else "smaller"
            shape = replace(model, indenter=indenter.model_copy(update={"radius": factor * radius}))
            if deepest > with_thickness(shape, parameters).depth_limit:
                continue
            other = replace(likelihood, force_model=shape)
            others[f"a {kind} radius, {_metres(factor * radius)},"] = other
    share = likelihood.noise / np.max(np.abs(likelihood.model(parameters)))
    designs = []
    for words, other in others.items():
        force = other.model(parameters)
        noise = share * float(np.max(np.abs(force)))
        designs.append(_design(words, replace(other, force=force, noise=noise), parameters))
    return now, sorted(designs, key=lambda design: design.worse)


def _design(words: str, likelihood: Likelihood, parameters: Coordinates) -> _Design:
    bound = likelihood.deviations(parameters)
    return _Design(words, bound[MODULUS], bound[TENSION] / parameters[TENSION])


def _with_tension(
    likelihood: Likelihood, parameters: Coordinates, tension: Estimate
) -> Coordinates:
    """Return the parameters, with a tension that the curve could just miss if it shows none."""
    if tension.low is not None:
        return parameters
    return parameters | {TENSION: (tension.high or likelihood.ranges[TENSION].scale) / 2}


def _metres(value: float) -> str:
    for factor, unit in ((1e-3, "mm"), (1e-6, "µm")):
        if value >= factor:
            return f"{value / factor:.3g} {unit}"
    return f"{value / 1e-9:.3g} nm"
