"""Which experiment would tell more: the Cramér–Rao bound of other radii and other ranges."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pellicle.arrays import Array

from .estimate import Estimate
from .likelihood import MODULUS, POINT, TENSION, Likelihood

_FACTORS = (1 / 10, 1 / 3, 3.0, 10.0)
_DEEPEST = 0.5
"""Depth over radius that no advice goes beyond: linear elasticity ends about there."""
_USELESS = 10.0
"""A relative standard deviation that says nothing."""
_GAIN = 1.3
"""An experiment is worth naming if it tightens by this factor."""


@dataclass(frozen=True)
class Design:
    """An experiment, and the standard deviations that no unbiased fit of it could beat."""

    words: str
    modulus: float
    """Of the modulus, relative."""
    tension: float
    """Of the tension, relative."""

    @property
    def worse(self) -> float:
        """The greater of the two."""
        return max(self.modulus, self.tension)


def designs(likelihood: Likelihood, parameters: Array) -> tuple[Design, list[Design]]:
    """Return the experiment as it was and others, best first.

    The others keep the number of points, the share of them before contact, and the noise relative
    to the largest force.
    """
    now = _design("this curve", likelihood, parameters)
    deepest = float(likelihood.position[-1] - parameters[POINT])
    others = []
    radius = getattr(likelihood.indenter, "radius", None)
    for factor in _FACTORS:
        if radius is None or factor * deepest <= _DEEPEST * radius:
            kind = "deeper" if factor > 1 else "shallower"
            how = f"a {kind} range, to {_metres(factor * deepest)},"
            others.append(_design(how, _deeper(likelihood, parameters, factor), parameters))
        if radius is not None and deepest <= _DEEPEST * factor * radius:
            how = f"a {'larger' if factor > 1 else 'smaller'} radius, {_metres(factor * radius)},"
            others.append(_design(how, _other_radius(likelihood, parameters, factor), parameters))
    return now, sorted(others, key=lambda design: design.worse)


def decidable(now: Design, others: list[Design]) -> bool:
    """Return whether this experiment or one of the others says anything of both parameters."""
    return any(design.worse < _USELESS for design in [now, *others])


def advice(likelihood: Likelihood, parameters: Array, modulus: Estimate, tension: Estimate) -> str:
    """Return advice, if both modulus and tension were asked for."""
    if not {MODULUS, TENSION} <= set(likelihood.free):
        return ""
    if tension.value and not np.isfinite([modulus.bound, tension.bound]).all():
        return (
            "the force is so far from linear in modulus and tension that no bound (Cramér–Rao) of "
            "their errors holds; the intervals do"
        )
    supposed = _with_tension(likelihood, parameters, tension)
    text = _advice(likelihood, supposed)
    if tension.value == supposed[TENSION]:
        return text
    return f"for a tension of {supposed[TENSION]:.2g} N/m: {text}"


def undecided(
    modulus: Estimate,
    tension: Estimate,
    likelihood: Likelihood,
    parameters: Array,
) -> list[str]:
    """Say why an interval is open."""
    if modulus.held or tension.held:
        return []
    if modulus.low is None or modulus.high is None or tension.high is None:
        which = "modulus" if modulus.low is None or modulus.high is None else "tension"
        depth = float(likelihood.position[-1] - parameters[POINT])
        length = 2 * tension.value / modulus.value
        text = (
            f"the curve cannot tell modulus and tension apart: the interval of the {which} is "
            "open, its value is one of many"
        )
        if decidable(*designs(likelihood, _with_tension(likelihood, parameters, tension))):
            text += f"; the curve is too {'shallow' if length > depth else 'deep'}"
        return [text]
    return []


def _with_tension(likelihood: Likelihood, parameters: Array, tension: Estimate) -> Array:
    """Return the parameters, with a tension that the curve could just miss if it shows none."""
    supposed = parameters.copy()
    if tension.low is None:
        supposed[TENSION] = (tension.high or likelihood.scale[TENSION]) / 2
    return supposed


def _advice(likelihood: Likelihood, parameters: Array) -> str:
    """Return in words which experiment would tighten modulus and tension."""
    now, others = designs(likelihood, parameters)
    reached = (
        f"no unbiased fit of this curve could beat ± {percent(now.modulus)} of the modulus and "
        f"± {percent(now.tension)} of the tension (Cramér–Rao bound, one standard deviation)"
    )
    if not decidable(now, others):
        return (
            f"{reached}; with this indenter no other radius or range would tell them apart: hold "
            "one of them, or press with another shape"
        )
    if not others or not others[0].worse * _GAIN < now.worse:
        return f"{reached}; more points or less noise would help, another radius or range hardly"
    best = others[0]
    return (
        f"{reached}; {best.words} at the same noise relative to the largest force would bring "
        f"± {percent(best.modulus)} and ± {percent(best.tension)}"
    )


def _design(words: str, likelihood: Likelihood, parameters: Array) -> Design:
    bound = likelihood.deviations(parameters)
    return Design(words, float(bound[MODULUS]), float(bound[TENSION] / parameters[TENSION]))


def _deeper(likelihood: Likelihood, parameters: Array, factor: float) -> Likelihood:
    position = parameters[POINT] + factor * (likelihood.position - parameters[POINT])
    return _measured(replace(likelihood, position=position), likelihood, parameters)


def _other_radius(likelihood: Likelihood, parameters: Array, factor: float) -> Likelihood:
    indenter: Any = likelihood.indenter
    other = indenter.model_copy(update={"radius": factor * indenter.radius})
    return _measured(replace(likelihood, indenter=other), likelihood, parameters)


def _measured(other: Likelihood, likelihood: Likelihood, parameters: Array) -> Likelihood:
    """Return an experiment with the same noise relative to its largest force."""
    share = likelihood.noise / np.max(np.abs(likelihood.model(parameters)))
    force = other.model(parameters)
    return replace(other, force=force, noise=share * float(np.max(np.abs(force))))


def _metres(value: float) -> str:
    for factor, unit in ((1e-3, "mm"), (1e-6, "µm")):
        if value >= factor:
            return f"{value / factor:.3g} {unit}"
    return f"{value / 1e-9:.3g} nm"


def percent(share: float) -> str:
    """Return a share as a message shows it."""
    return f"{100 * share:.2g} %" if share < 10 else "more than 1000 %"
