"""What is asked of a curve: indenter, solid, and the parameters that are held."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from pellicle.components import HasForceCurve, Indenter
from pellicle.errors import ConfigError
from pellicle.model.messages import nearest
from pellicle.plugins import registry
from pellicle.units import Quantity

from .curves.curve import LARGEST, Segment
from .models.force_model import (
    CONTACT_POINT,
    MODULUS,
    OFFSET,
    SLOPE,
    TENSION,
    Coordinates,
    Parameter,
)
from .models.solid import DEFAULT_KERNEL, Solid, solid

Baseline = Literal["none", "offset", "slope"]

_FIXABLE = {parameter.name: parameter for parameter in (CONTACT_POINT, MODULUS, TENSION)}
_BASELINES: dict[str, tuple[Parameter, ...]] = {
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
    fixed: Coordinates
    """Parameters that are not fitted."""
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
    fixed = _fixed(fix or {}, is_depth)
    if segment not in ("approach", "retract"):
        raise ConfigError(f"{segment!r} is not allowed; give approach or retract", "segment")
    if baseline not in _BASELINES:
        raise ConfigError(
            f"{baseline!r} is not allowed; {nearest(baseline, _BASELINES)}", "baseline"
        )
    if {MODULUS, TENSION} <= set(fixed):
        raise ConfigError("fixes both modulus and tension; leave one of them to the fit", "fix")
    fixed |= {p: 0.0 for p in (OFFSET, SLOPE) if p not in _BASELINES[baseline]}
    return Question(shape, material, fixed, segment, ratio)


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


def _fixed(fix: Mapping[str, Any], is_depth: bool) -> Coordinates:
    fixed: Coordinates = {CONTACT_POINT: 0.0} if is_depth else {}
    for name, value in fix.items():
        if name not in _FIXABLE:
            raise ConfigError(f"is no parameter; {nearest(name, _FIXABLE)}", f"fix.{name}")
        parameter = _FIXABLE[name]
        least = 1 / LARGEST if parameter.logarithmic else max(parameter.minimum, -LARGEST)
        try:
            number = Quantity(parameter.unit, at_least=least, at_most=LARGEST)(value)
        except ValueError as error:
            raise ConfigError(str(error), f"fix.{name}") from None
        fixed[parameter] = parameter.coordinate(number)
    return fixed


def _ratio(given: float | None) -> float | None:
    if given is None:
        return None
    try:
        return Quantity("1", above=-1, at_most=0.5)(given)
    except ValueError as error:
        raise ConfigError(str(error), "poissons_ratio") from None
