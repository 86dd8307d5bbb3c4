"""Reduced modulus, tension and contact point of a measured curve, with what is known of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import fdtrc, stdtrit

from pellicle.components import Component, Executor, HasForceCurve, Indenter
from pellicle.errors import ConfigError
from pellicle.model import nearest
from pellicle.operators import Array
from pellicle.plugins import registry
from pellicle.units import Quantity

from .curve import Curve, Segment, clean
from .design import advice, decidable, designs
from .interval import Better, Minimum, interval
from .likelihood import MODULUS, OFFSET, POINT, SLOPE, TENSION, ChiSquared, Likelihood
from .measured import Calibration, Measured
from .simulated import SimulatedCurve
from .simulation import GRID_POINTS, simulate
from .solid import DEFAULT_KERNEL, Solid, lengths, solid
from .start import BEFORE, starts
from .written import as_json, write_json

Baseline = Literal["none", "offset", "slope"]

CONFIDENCE = 0.95
_NAMES = {
    "contact_point": (POINT, Quantity("m")),
    "reduced_modulus": (MODULUS, Quantity("Pa", above=0)),
    "tension": (TENSION, Quantity("N/m", at_least=0)),
}
_BASELINES: dict[str, tuple[int, ...]] = {
    "none": (),
    "offset": (OFFSET,),
    "slope": (OFFSET, SLOPE),
}
_QUIET = 20
"""Points before contact that the noise can be taken from."""
_OFF = 4.0
"""Standard errors that the force before contact may be from 0."""
_CHANCE = 1e-3
"""A misfit less likely than this is no chance."""
_PLAUSIBLE_DEPTH = (1e-3, 1.0)
_PLAUSIBLE_MODULUS = (1.0, 1e12)
_PLAUSIBLE_TENSION = 10.0


@dataclass(frozen=True)
class Estimate:
    """One parameter: its value, and the 95 % interval of its profile likelihood."""

    value: float
    low: float | None
    """Lower end; None if the curve sets none (for a tension: it may be 0)."""
    high: float | None
    """Upper end; None if the curve sets none."""
    unit: str
    bound: float
    """Cramér–Rao bound at the value, as a standard deviation; 0 if held."""
    held: bool = False
    """Whether it was given, not fitted."""

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold; an open end is None."""
        bound = self.bound if np.isfinite(self.bound) else None
        return {
            "value": self.value,
            "low": self.low,
            "high": self.high,
            "unit": self.unit,
            "bound": bound,
            "held": self.held,
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


@dataclass(frozen=True)
class Fit:
    """What a curve says of the solid, and how sure it is."""

    reduced_modulus: Estimate
    """E* [Pa]."""
    tension: Estimate
    """τ₀ [N/m]."""
    contact_point: Estimate
    """Position of first touch [m]."""
    offset: Estimate
    """Force of the baseline at the first position [N]."""
    slope: Estimate
    """Slope of the baseline [N/m]."""
    youngs_modulus: Estimate | None
    """E = (1 − ν²) E* [Pa], if Poisson's ratio was given."""
    noise: float
    """Standard deviation of the force [N]."""
    noise_from: str
    """What it was estimated from."""
    points: int
    """Rows that were used."""
    chi_squared: float
    """Least sum of squared residuals over the noise."""
    chi_squared_without_tension: float
    """The same with tension held at 0."""
    comparison: str
    """Whether tension is needed, in words."""
    advice: str
    """The bound that was reached, and what would tighten it."""
    messages: tuple[str, ...]
    """What to be careful of."""
    likelihood: Likelihood
    """The curve and its χ²."""
    parameters: Array
    """Parameters of the fit, in the order of `likelihood`."""
    parameters_without_tension: Array
    """The same with tension held at 0 (Hertz, for a paraboloid)."""
    rise: float
    """Rise of χ² at the ends of the intervals."""

    def estimates(self) -> dict[str, Estimate]:
        """Return the parameters by name; a baseline and Young's modulus only if asked for."""
        return {
            name: value
            for name, value in vars(self).items()
            if isinstance(value, Estimate) and not (value.held and name in ("offset", "slope"))
        }

    def save(self, path: str | Path) -> Path:
        """Write what `to_dict` returns to a JSON file, and return its name.

        Raises
        ------
        StorageError
            The file cannot be written.
        """
        return write_json(self.to_dict(), Path(path))

    def to_json(self) -> str:
        """Return what `to_dict` returns as JSON."""
        return as_json(self.to_dict())

    def model(self) -> dict[str, Any]:
        """Return indenter and kernel that were fitted with, as JSON has them.

        A kernel is there only if its force curve was simulated, without modulus and tension.
        """
        return described(self.likelihood.indenter)

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        gain = self.chi_squared_without_tension - self.chi_squared
        return {name: value.to_dict() for name, value in self.estimates().items()} | {
            "model": self.model(),
            "confidence": CONFIDENCE,
            "noise": {"value": self.noise, "unit": "N", "from": self.noise_from},
            "points": self.points,
            "chi_squared": self.chi_squared,
            "without_tension": {"delta_chi_squared": gain, "delta_aic": gain - 2},
            "comparison": self.comparison,
            "advice": self.advice,
            "messages": list(self.messages),
        }


def fit(
    position: ArrayLike | None = None,
    force: ArrayLike | None = None,
    *,
    depth: ArrayLike | None = None,
    indenter: str | Mapping[str, Any] | Indenter | HasForceCurve,
    kernel: str | Mapping[str, Any] | None = None,
    poissons_ratio: float | None = None,
    fix: Mapping[str, Any] | None = None,
    baseline: Baseline = "none",
    segment: Segment = "approach",
    spring_constant: float | str | None = None,
    cache: str | Path | None = None,
    executor: str | Mapping[str, Any] | Executor = "serial",
    grid_points: int = GRID_POINTS,
    progress: bool = False,
    **fields: Any,
) -> Fit:
    """Fit reduced modulus, tension and contact point to one measured curve.

    The solid is a half-space under tension unless a kernel is given, the contact frictionless and
    without adhesion.  Errors of the force are taken as normal, independent and equal at all points;
    the intervals hold 95 %.

    An indenter that has a force curve of its own (paraboloid, sphere, cone, flat_punch) is fitted
    at once.  Any other, or any on another kernel, needs a study of some 150 runs first, which is
    kept in ``cache`` and serves all curves of the same proportions.

    Parameters
    ----------
    position, force
        Position of the indenter [m], growing into the solid, and force [N], both of shape (n,).
    depth
        Depth [m] instead of position: the contact point is then held at 0.
    indenter
        An indenter, its table, or its type with the fields that the type needs:
        ``indenter="paraboloid", radius="5 um"``; or anything that has a force curve.
    kernel
        Type or table of the kernel, without the modulus and the tension that are sought.
    poissons_ratio
        ν, to give Young's modulus as well; also that of a kernel that needs one and has none.
    fix
        Parameters to hold, e.g. ``{"tension": 0}``: reduced_modulus, tension, contact_point.
    baseline
        What is fitted of the force before contact: ``"none"``, its ``"offset"``, or offset and
        ``"slope"``.
    segment
        The pass that is fitted of a curve with two: ``"approach"`` or ``"retract"``.
    spring_constant
        Of the cantilever [N/m], if position is that of its base less its deflection: noise of the
        deflection is then in both, position and force, and is reckoned with.
    cache
        Folder that keeps studies; the user's cache folder if None.
    executor
        What carries out a study.
    grid_points
        Cells of each grid of a study along x and y.
    progress
        Show how far a study is.

    Raises
    ------
    ConfigError, PluginError
        The curve cannot be fitted, or an argument is not allowed.
    ConvergenceError, StorageError
        A study did not come to its end.
    """
    asked = question(
        indenter,
        fields,
        is_depth=depth is not None,
        kernel=kernel,
        poissons_ratio=poissons_ratio,
        fix=fix,
        baseline=baseline,
        segment=segment,
    )
    if (position is None) == (depth is None):
        raise ConfigError("give either position or depth")
    if force is None:
        raise ConfigError("is missing; give the force [N] at each position", "force")
    stiffness = Calibration.of(spring_constant).spring_constant
    curve = cleaned(Measured(force, position, depth, stiffness=stiffness), segment)  # type: ignore[arg-type]
    model = modelled(
        asked,
        curve,
        cache=cache,
        executor=executor,
        grid_points=grid_points,
        progress=progress,
    )
    return fitted(curve, model)


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


def cleaned(measured: Measured, segment: Segment) -> Curve:
    """Return the rows of a measured curve that are fitted.

    Raises
    ------
    ConfigError
        As for `clean`.
    """
    place = measured.position if measured.depth is None else measured.depth
    made = clean(place, measured.force, segment, measured.stiffness)  # type: ignore[arg-type]
    return replace(made, messages=(*measured.messages, *made.messages))


def modelled(
    asked: Question,
    curve: Curve,
    *,
    cache: str | Path | None = None,
    executor: str | Mapping[str, Any] | Executor = "serial",
    grid_points: int = GRID_POINTS,
    progress: bool = False,
) -> Question:
    """Return the question with an indenter that has a force curve, simulated if need be.

    Raises
    ------
    ConfigError, ConvergenceError, StorageError
        As for `simulate`.
    """
    if asked.material is None:
        return asked
    span = float(np.ptp(curve.position))
    held = POINT not in asked.free
    reach = float(curve.position[-1]) - asked.held[POINT] if held else (1 + BEFORE) * span
    made = simulate(
        asked.indenter,
        asked.material,
        # Where nothing reaches contact, the fit itself says so.
        reach if reach > 0 else span,
        cache=None if cache is None else Path(cache),
        executor=executor,
        grid_points=grid_points,
        progress=progress,
    )
    return replace(asked, indenter=made, material=None)


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


@dataclass(frozen=True)
class Explained:
    """A curve on its own: its likelihood with its noise, and the best parameters."""

    likelihood: Likelihood
    parameters: Array
    freedom: float
    """Degrees of freedom of the noise."""
    noise_from: str
    messages: tuple[str, ...]


def explain(curve: Curve, asked: Question) -> Explained:
    """Return the best parameters of a curve and its noise.

    Raises
    ------
    ConfigError
        Nothing explains the curve.
    """
    messages = list(curve.messages)
    largest = float(np.max(np.abs(curve.force)))
    rough = Likelihood(
        curve.position, curve.force, asked.indenter, largest, asked.free, curve.stiffness
    )
    minimum = _best([rough.minimise(start) for start in _starts(rough, asked.held)])
    noise, freedom, source = _noise(rough, minimum.parameters, messages)
    return Explained(
        replace(rough, noise=noise), minimum.parameters, freedom, source, tuple(messages)
    )


def fitted(curve: Curve, asked: Question) -> Fit:
    """Return the fit of a curve by an indenter that has a force curve.

    Raises
    ------
    ConfigError
        The curve cannot be fitted.
    """
    alone = explain(curve, asked)
    likelihood, free, messages = alone.likelihood, asked.free, list(alone.messages)
    rise = allowed_rise(alone.freedom)
    best, without, ends = _profiled(likelihood, alone.parameters, rise)
    ends = widened(ends, likelihood, best, messages)
    point, log_modulus = best.parameters[POINT], best.parameters[MODULUS]
    bound = likelihood.deviations(best.parameters)
    modulus = float(np.exp(log_modulus))
    plausible(curve, asked.indenter, point, modulus, float(best.parameters[TENSION]), messages)

    def estimate(which: int, unit: str) -> Estimate:
        value = float(best.parameters[which])
        if which not in free:
            return Estimate(value, value, value, unit, 0.0, held=True)
        return Estimate(value, *ends[which], unit, float(bound[which]))

    log = estimate(MODULUS, "Pa")
    reduced = of_log(log)
    tension = estimate(TENSION, "N/m")
    gain = without.chi_squared - best.chi_squared
    _open(reduced, tension, likelihood, best.parameters, messages)
    return Fit(
        reduced_modulus=reduced,
        tension=tension,
        contact_point=estimate(POINT, "m"),
        offset=estimate(OFFSET, "N"),
        slope=estimate(SLOPE, "N/m"),
        youngs_modulus=youngs_modulus(reduced, asked.poissons_ratio),
        noise=likelihood.noise,
        noise_from=alone.noise_from,
        points=curve.force.size,
        chi_squared=best.chi_squared,
        chi_squared_without_tension=without.chi_squared,
        comparison=comparison(tension, gain),
        advice=_advice(likelihood, best.parameters, tension),
        messages=tuple(messages),
        likelihood=likelihood,
        parameters=best.parameters,
        parameters_without_tension=without.parameters,
        rise=rise,
    )


def described(curve: HasForceCurve) -> dict[str, Any]:
    """Return indenter and, if it was simulated, kernel of a force curve, as JSON has them."""
    if isinstance(curve, SimulatedCurve):
        said = {"kernel": dict(curve.kernel), "accuracy": curve.accuracy}
        return {"indenter": curve.indenter.model_dump(mode="json", exclude_none=True), **said}
    if isinstance(curve, Component):
        return {"indenter": curve.model_dump(mode="json", exclude_none=True)}
    return {"indenter": {"type": type(curve).__name__}}


def allowed_rise(freedom: float) -> float:
    """Return the rise of χ² at the ends of an interval, with the noise known that well."""
    return float(stdtrit(freedom, (1 + CONFIDENCE) / 2) ** 2)


def youngs_modulus(reduced: Estimate, poissons_ratio: float | None) -> Estimate | None:
    """Return E = (1 − ν²) E*, if ν was given."""
    return None if poissons_ratio is None else _times(reduced, 1 - poissons_ratio**2)


def _starts(likelihood: Likelihood, held: Array) -> list[Array]:
    found = starts(likelihood, held)
    if not found:
        raise ConfigError(
            "is nowhere pushed back as an indenter would be; check signs, indenter and fix", "force"
        )
    return found


def _best(found: list[tuple[Array, float]]) -> Minimum:
    return Minimum(*min(found, key=lambda each: each[1]))


def _noise(rough: Likelihood, parameters: Array, messages: list[str]) -> tuple[float, float, str]:
    """Return standard deviation [N], its degrees of freedom, and where it comes from."""
    residuals = rough.residuals(parameters) * rough.noise
    least = rough.accuracy * rough.noise
    span = float(np.ptp(rough.position))
    before = rough.position < parameters[POINT] - 0.01 * span
    baseline = sum(k in rough.free for k in (OFFSET, SLOPE))
    freedom = residuals.size - len(rough.free)
    overall = float(np.sqrt(np.sum(residuals**2) / freedom))
    if before.sum() < _QUIET:
        messages.append(
            f"only {before.sum()} points lie before contact, so the noise is taken from the "
            "residuals of the fit, and how well the model fits cannot be told; start further out"
        )
        return max(overall, least), freedom, "residuals of the fit"
    # About their mean: an offset that is not fitted is no noise.
    mean = 0.0 if baseline else float(np.mean(residuals[before]))
    quiet = float(before.sum()) - max(baseline, 1)
    noise = max(float(np.sqrt(np.sum((residuals[before] - mean) ** 2) / quiet)), least)
    source = f"{before.sum()} points before contact"
    if abs(mean) > _OFF * noise / np.sqrt(quiet) and abs(mean) > 10 * least:
        messages.append(
            f"the force before contact is {-mean:.3g} N, not 0, and modulus and tension are off by "
            "it; fit it too, with baseline 'offset', or 'slope' if it drifts"
        )
    contact = residuals[~before]
    loose = max(contact.size - (len(rough.free) - baseline), 1)
    misfit = float(np.sum(contact**2)) / loose / noise**2
    if misfit > 1 and fdtrc(loose, quiet, misfit) < _CHANCE:
        held = "" if POINT in rough.free else f", contact from {parameters[POINT]:g} m on"
        messages.append(
            f"in contact the residuals are {np.sqrt(misfit):.2g} times the noise before it: the "
            f"model (this indenter, this elastic solid, no adhesion{held}) does not describe the "
            "curve; the intervals are widened by that factor"
        )
        return noise * float(np.sqrt(misfit)), min(quiet, loose), f"{source}, widened by the misfit"
    return noise, quiet, source


def _profiled(
    likelihood: Likelihood, start: Array, rise: float
) -> tuple[Minimum, Minimum, dict[int, tuple[float | None, float | None]]]:
    """Return the minimum, that without tension, and the interval of each free parameter."""
    best = Minimum(*likelihood.minimise(start))
    while True:
        without = _without_tension(likelihood, best)
        if TENSION in likelihood.free and without.chi_squared <= best.chi_squared + 1e-6:
            # As good, and then exactly on the edge.
            best = without
        try:
            ends = {k: interval(likelihood, best, k, rise) for k in likelihood.free}
        except Better as better:
            best = Minimum(*likelihood.minimise(better.minimum.parameters))
            if best.chi_squared > better.minimum.chi_squared:
                best = better.minimum
        else:
            return best, without, ends


def widened(
    ends: dict[int, tuple[float | None, float | None]],
    likelihood: ChiSquared,
    best: Minimum,
    messages: list[str],
) -> dict[int, tuple[float | None, float | None]]:
    """Return intervals with what the grids of a simulated curve may have shifted added to them."""
    coarser = likelihood.coarse()
    if coarser is None:
        return ends
    coarse, _ = coarser.minimise(best.parameters)
    shift = np.abs(coarse - best.parameters)
    tension = best.parameters[TENSION]
    said = [f"the modulus by {100 * np.expm1(shift[MODULUS]):.2g} %"] * (MODULUS in ends)
    if TENSION in ends and tension:
        said.append(f"the tension by {100 * shift[TENSION] / tension:.2g} %")
    messages.append(
        f"the force curve is simulated, to {100 * likelihood.accuracy:.2g} %; half as many cells "
        f"change {' and '.join(said)}, and the intervals are widened by that"
    )
    wider = {}
    for which, (low, high) in ends.items():
        low = None if low is None else low - shift[which]
        if which == TENSION and low is not None and low <= 0:
            low = None
        wider[which] = low, None if high is None else high + shift[which]
    return wider


def _without_tension(likelihood: Likelihood, best: Minimum) -> Minimum:
    start = best.parameters.copy()
    start[TENSION] = 0.0
    held = replace(likelihood, free=tuple(k for k in likelihood.free if k != TENSION))
    found = [held.minimise(start)]
    found += [held.minimise(each) for each in starts(held, start)[:1]]
    return _best(found)


def of_log(log: Estimate) -> Estimate:
    """Return the modulus whose logarithm is estimated."""
    value = float(np.exp(log.value))
    low, high = (None if end is None else float(np.exp(end)) for end in (log.low, log.high))
    return replace(log, value=value, low=low, high=high, bound=log.bound * value)


def _times(estimate: Estimate, factor: float) -> Estimate:
    low, high = (None if end is None else end * factor for end in (estimate.low, estimate.high))
    return replace(
        estimate, value=estimate.value * factor, low=low, high=high, bound=estimate.bound * factor
    )


def comparison(tension: Estimate, gain: float) -> str:
    """Return in words whether tension is needed; ``gain`` is how much it lowers χ²."""
    figures = f"Δχ² = {gain:.3g}, ΔAIC = {gain - 2:.3g}"
    if tension.held and not tension.value:
        return "tension is held at 0, so whether it is needed was not asked"
    if tension.held:
        return f"tension is held at {tension.value:.4g} N/m ({figures} against none)"
    if tension.low is not None:
        return f"tension is needed ({figures} against none)"
    if tension.high is not None:
        return f"this curve does not show tension ({figures}); it is below {tension.high:.3g} N/m"
    return f"this curve does not show tension ({figures}), and sets no bound on it"


def _advice(likelihood: Likelihood, parameters: Array, tension: Estimate) -> str:
    """Return advice, if both modulus and tension were asked for."""
    if not {MODULUS, TENSION} <= set(likelihood.free):
        return ""
    supposed = _with_tension(likelihood, parameters, tension)
    text = advice(likelihood, supposed)
    if tension.value == supposed[TENSION]:
        return text
    return f"for a tension of {supposed[TENSION]:.2g} N/m: {text}"


def _with_tension(likelihood: Likelihood, parameters: Array, tension: Estimate) -> Array:
    """Return the parameters, with a tension that the curve could just miss if it shows none."""
    supposed = parameters.copy()
    if tension.low is None:
        supposed[TENSION] = (tension.high or likelihood.scale[TENSION]) / 2
    return supposed


def _open(
    modulus: Estimate,
    tension: Estimate,
    likelihood: Likelihood,
    parameters: Array,
    messages: list[str],
) -> None:
    """Say why an interval is open."""
    if modulus.held or tension.held:
        return
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
        messages.append(text)


def plausible(
    curve: Curve, indenter: Any, point: float, modulus: float, tension: float, messages: list[str]
) -> None:
    """Refuse or warn of what a wrong unit or radius would give."""
    depth = float(curve.position[-1]) - point
    shape = indenter.indenter if isinstance(indenter, SimulatedCurve) else indenter
    radius = next(iter(lengths(shape)), None) if isinstance(shape, Component) else None
    if depth > indenter.depth_limit:
        raise ConfigError(
            f"the depth reaches {depth:.3g} m, and the curve of this indenter ends at "
            f"{indenter.depth_limit:.3g} m; is the radius right? If so, leave out the deepest part",
            "indenter",
        )
    if radius is not None and not _PLAUSIBLE_DEPTH[0] <= depth / radius <= _PLAUSIBLE_DEPTH[1]:
        messages.append(
            f"the depth of {depth:.3g} m is {depth / radius:.3g} times the radius of "
            f"{radius:.3g} m: are radius and units right?"
        )
    if not _PLAUSIBLE_MODULUS[0] <= modulus <= _PLAUSIBLE_MODULUS[1]:
        messages.append(f"a modulus of {modulus:.3g} Pa is not plausible: are the units right?")
    if tension > _PLAUSIBLE_TENSION:
        messages.append(f"a tension of {tension:.3g} N/m is not plausible: are the units right?")
