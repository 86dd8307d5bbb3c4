"""What is asked of a curve: indenter, solid, and the parameters that are held."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from pellicle.arrays import Array
from pellicle.components import HasForceCurve, Indenter
from pellicle.errors import ConfigError
from pellicle.model.messages import nearest
from pellicle.plugins import registry
from pellicle.units import Quantity

from .curves.curve import LARGEST, Segment
from .models.solid import DEFAULT_KERNEL, Solid, solid
from .statistics.likelihood import MODULUS, OFFSET, POINT, SLOPE, TENSION

Baseline = Literal["none", "offset", "slope"]

_NAMES = {
    "contact_point": (POINT, Quantity("m", at_least=-LARGEST, at_most=LARGEST)),
    "reduced_modulus": (MODULUS, Quantity("Pa", at_least=1 / LARGEST, at_most=LARGEST)),
    "tension": (TENSION, Quantity("N/m", at_least=0, at_most=LARGEST)),
}
_BASELINES: dict[str, tuple[int, ...]] = {
    "none": (),
    "offset": (OFFSET,),
    "slope": (OFFSET, SLOPE),
}


@dataclass(frozen=True)
class Question:
    """What is asked of a curve."""

    indenter: Any
    """It has a force curve, or is pressed into `material`."""
    material: Solid | None
    """What is to be simulated; None if nothing is."""
    held: Array
    """Parameters, in the order of `likelihood`; of the free ones, anything."""
    free: tuple[int, ...]
    segment: Segment
    poissons_ratio: float | None


def question(
    indenter: str | Mapping[str, Any] | Indenter | HasForceCurve,
    fields: Mapping[str, Any],
    *,
    is_depth: bool,
    kernel: str | Mapping[str, Any] | None = None,
    poissons_ratio: float | None = None,
    fix: Mapping[str, Any] | None = None,
    baseline: Baseline = "none",
    segment: Segment = "approach",
) -> Question:
    """Return what the arguments of `fit` ask.

    Raises
    ------
    ConfigError, PluginError
        One of them is not allowed.
    """
    shape = _indenter(indenter, fields)
    ratio = _ratio(poissons_ratio)
    if kernel is None and not isinstance(shape, HasForceCurve):
        kernel = DEFAULT_KERNEL
    material = None if kernel is None else solid(kernel, ratio)
    if material is not None:
        if not isinstance(shape, Indenter):
            raise ConfigError("is given beside a force curve, which has one already", "kernel")
        ratio = material.poissons_ratio
    held = _held(fix or {}, is_depth)
    free = tuple(k for k in range(3) if k not in held)
    if segment not in ("approach", "retract"):
        raise ConfigError(f"{segment!r} is not allowed; give approach or retract", "segment")
    if baseline not in _BASELINES:
        raise ConfigError(
            f"{baseline!r} is not allowed; {nearest(baseline, _BASELINES)}", "baseline"
        )
    if not {MODULUS, TENSION} & set(free):
        raise ConfigError("holds both modulus and tension; leave one of them to the fit", "fix")
    values = np.zeros(5)
    for k, value in held.items():
        values[k] = value
    free += _BASELINES[baseline]
    return Question(shape, material, values, free, segment, ratio)


def _indenter(
    given: str | Mapping[str, Any] | Indenter | HasForceCurve, fields: Mapping[str, Any]
) -> Any:
    if isinstance(given, str):
        given = {"type": given, **fields}
    elif isinstance(given, Mapping):
        given = {**given, **fields}
    elif fields:
        raise ConfigError(f"{', '.join(fields)} given beside an indenter that is complete")
    if isinstance(given, HasForceCurve):
        return given
    try:
        return registry().make(Indenter, given)
    except ConfigError as error:
        raise error.within("indenter") from None


def _held(fix: Mapping[str, Any], is_depth: bool) -> dict[int, float]:
    held: dict[int, float] = {POINT: 0.0} if is_depth else {}
    for name, value in fix.items():
        if name not in _NAMES:
            raise ConfigError(f"is no parameter; {nearest(name, _NAMES)}", f"fix.{name}")
        which, quantity = _NAMES[name]
        try:
            number = quantity(value)
        except ValueError as error:
            raise ConfigError(str(error), f"fix.{name}") from None
        held[which] = float(np.log(number)) if which == MODULUS else number
    return held


def _ratio(given: float | None) -> float | None:
    if given is None:
        return None
    try:
        return Quantity("1", above=-1, at_most=0.5)(given)
    except ValueError as error:
        raise ConfigError(str(error), "poissons_ratio") from None
