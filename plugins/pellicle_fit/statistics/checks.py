"""Least-squares fit of one curve with its noise, and the checks that its residuals fail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from pellicle.arrays import Array
from pellicle.components import Component, HasForceCurve, IsShallowLimit
from pellicle.errors import ConfigError, ConvergenceError
from pellicle.units import decimal, readable
from pellicle_fit.long_memory import exponent_of
from pellicle_fit.models.force_model import ClosedFormModel, ForceModel
from pellicle_fit.models.layer import LayerModel, with_thickness
from pellicle_fit.models.solid import lengths
from pellicle_fit.parameters import CONTACT_POINT, MODULUS, TENSION, Coordinates, Parameter

from .chi_squared import ChiSquared, Minimum, best_minimum
from .initial_guess import initial_guesses
from .likelihood import Likelihood
from .noise import FailedCheck, Noise, NoiseEstimate, Residuals, check_baseline
from .profile import CONFIDENCE, Estimate

_QUIET = 20
"""Least number of points before contact from which the noise is estimated."""
_DEPTHS = (0, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 3 / 4, 1)
"""Edges of bins in contact, over the depth; narrow near first touch, where most models fail."""
_WILD = 7.0
"""Standard deviations from the mean of its neighbours beyond which a point is a spike."""
_NORMAL = 1.4826
"""Standard deviation of normal numbers over their median absolute deviation."""
SHALLOW = 0.1
"""Depth over radius beyond which a paraboloid differs from the sphere that it approximates."""
_ALIKE = 10.8
"""Δχ² below which another shape describes a curve as well (by chance exceeded in 0.1 %)."""
_PLAUSIBLE_DEPTH = (1e-3, 1.0)
"""Depth over radius."""


@dataclass(frozen=True)
class SingleFit:
    """The best parameters of one curve, its noise, and the checks that it fails."""

    likelihood: Likelihood
    """With the estimated noise."""
    parameters: Coordinates
    freedom: float
    """Degrees of freedom of the noise."""
    noise_from: str
    """Source of the noise estimate."""
    failed_checks: tuple[FailedCheck, ...]
    messages: tuple[str, ...]
    """Warnings, among them those of the checks."""


def fit_single(likelihood: Likelihood, fixed: Coordinates) -> SingleFit:
    """Return the best parameters of a curve, its noise, and the checks that it fails.

    The noise is the scatter before contact about a line and, if the force dips, the dip.  A check
    that fails may raise it to the scatter in contact or to the noise of sums over bins.  The noise
    of ``likelihood`` only scales χ².

    Raises
    ------
    ConfigError
        No modulus above 0 describes the curve, or its depth is beyond that to which the force model
        holds.
    ConvergenceError
        No search for the best parameters converges.
    """
    guesses = initial_guesses(likelihood, fixed)
    if not guesses:
        raise ConfigError(
            "is not described by any modulus above 0; check signs, indenter and fix", "force"
        )
    minimum = best_minimum(likelihood, guesses)
    estimate, source = judged(likelihood, minimum.parameters)
    if memory := _memory(likelihood, minimum.parameters, estimate):
        correlated = replace(likelihood, memory=memory)
        best = best_minimum(correlated, [minimum.parameters, *guesses])
        judgement = judged(correlated, best.parameters)
        # A bent baseline is not noise, and its fractional differences would remove the contact: a
        # measured curve with a clear contact got a modulus of 3e-14 Pa.
        if not {"misfit", "pattern"} & {check.code for check in judgement[0].failed}:
            likelihood, minimum, (estimate, source) = correlated, best, judgement
            falls = f"power falls as f^{-2 * memory:.2g}"
            source += f", whose {falls}"
            message = (
                f"the noise before contact is correlated: its {falls}, and fit and intervals take "
                "it so"
            )
            failed_check = FailedCheck("slow_noise", message)
            estimate = estimate._replace(failed=(failed_check, *estimate.failed))
    # Profiles and comparisons beyond the limit take a hundred times as long as this search.
    check_depth(likelihood.force_model, likelihood.deepest(minimum.parameters), minimum.parameters)
    noise, failed = estimate.noise, estimate.failed
    scaled = minimum.chi_squared * (likelihood.noise / noise.deviation) ** 2
    likelihood = replace(likelihood, noise=noise.deviation)
    notes, shape = check_shape(likelihood, minimum._replace(chi_squared=scaled))
    return SingleFit(
        likelihood,
        minimum.parameters,
        noise.freedom,
        source,
        (*failed, *shape),
        (*estimate.messages, *notes, *(check.message for check in (*failed, *shape))),
    )


def _memory(likelihood: Likelihood, parameters: Coordinates, estimate: NoiseEstimate) -> float:
    """Return the exponent of correlated noise before contact; 0 if it is not of that kind."""
    if "slow_noise" not in {check.code for check in estimate.failed}:
        return 0.0
    before = Residuals.of(likelihood, parameters).before
    return exponent_of(likelihood.misfit(parameters)[before])


def judged(likelihood: Likelihood, parameters: Coordinates) -> tuple[NoiseEstimate, str]:
    """Return the noise that residuals at best parameters show, its source, and failed checks."""
    residuals = Residuals.of(likelihood, parameters)
    count = int(residuals.before.sum())
    if count < _QUIET:
        source, before = "residuals of the fit", None
        lie = "point lies" if count == 1 else "points lie"
        messages: tuple[str, ...] = (
            f"only {count} {lie} before contact, so the noise is taken from the residuals of the "
            "fit, and drift or adhesion before contact cannot be detected; start further out, "
            "or fit the baseline too if the force out there is not 0",
        )
    else:
        source, before = f"{count} points before contact", check_baseline(residuals)
        messages = before.messages
    noise, in_contact, *_ = _check_contact(residuals, before)
    if before is not None and noise.deviation > before.noise.deviation:
        quiet = readable(before.noise.deviation, "N", 3)
        source = f"residuals in contact ({quiet} from {source})"
    failed = (*_spikes(residuals), *in_contact)
    if failed:
        source += f"; checks that fail: {', '.join(check.code for check in failed)}"
    return NoiseEstimate(noise, failed, messages=messages), source


def check_plausible(
    likelihood: Likelihood, parameters: Coordinates, estimate: Callable[[Parameter], Estimate]
) -> list[str]:
    """Return warnings of implausible results, such as a wrong unit or radius causes.

    ``estimate`` returns that of a parameter of the force model.

    Raises
    ------
    ConfigError
        The depth is beyond that to which the force model holds.
    """
    messages = []
    model, depth = likelihood.force_model, likelihood.deepest(parameters)
    check_depth(model, depth, parameters)
    shape = getattr(model, "indenter", None)
    radius = next(iter(lengths(shape)), None) if isinstance(shape, Component) else None
    if radius is not None and not _PLAUSIBLE_DEPTH[0] <= depth / radius <= _PLAUSIBLE_DEPTH[1]:
        messages.append(
            f"the depth of {readable(depth, 'm', 3)} is {depth / radius:.3g} times the radius of "
            f"{readable(radius, 'm', 3)}: are radius and units right?"
        )
    for parameter in model.parameters:
        known, (least_value, most) = estimate(parameter), parameter.plausible
        # The best value of an open interval is one of many.
        low = -np.inf if known.low is None else known.low
        high = np.inf if known.high is None else known.high
        if low > most or high < least_value:
            size = known.only_end or f"of {readable(known.value, known.unit, 3)}"
            messages.append(f"a {parameter.word} {size} is not plausible: are the units right?")
    return messages


def check_depth(model: ForceModel, depth: float, parameters: Coordinates) -> None:
    """Raise ConfigError if a depth [m] is beyond that to which the force model holds."""
    model = with_thickness(model, parameters)
    if depth <= model.depth_limit:
        return
    if isinstance(model, LayerModel):
        raise ConfigError(
            f"the depth reaches {readable(depth, 'm', 3)}, and the curve of this indenter on a "
            f"layer {readable(model.thickness, 'm', 3)} thick ends at "
            f"{readable(model.depth_limit, 'm', 3)}: there it reaches "
            "the base, its contact is ten times as wide as the layer is thick, or the shape ends. "
            "Are thickness and radius right? If so, leave out the deepest part",
            "thickness",
        )
    raise ConfigError(
        f"the depth reaches {readable(depth, 'm', 3)}, and the curve of this indenter ends at "
        f"{readable(model.depth_limit, 'm', 3)}; are radius and units right? If the force before "
        "contact is not 0, fit the baseline too, with baseline 'offset'; else leave out the "
        "deepest part",
        "indenter",
    )


def _spikes(residuals: Residuals) -> list[FailedCheck]:
    """Return a failed check if points lie far from the mean of their neighbours."""
    force = residuals.force
    if force.size < _QUIET:
        return []
    off = force[1:-1] - (force[2:] + force[:-2]) / 2
    spread = max(_NORMAL * float(np.median(np.abs(off - np.median(off)))), residuals.floor)
    # A spike also shifts the means beside it, by half as much and in the other direction.
    wild = np.abs(off) > _WILD * spread
    wild[1:-1] &= (np.abs(off[1:-1]) >= np.abs(off[:-2])) & (np.abs(off[1:-1]) >= np.abs(off[2:]))
    if not (count := int(wild.sum())):
        return []
    first = residuals.likelihood.position[int(np.argmax(wild)) + 1]
    message = (
        f"{'1 point lies' if count == 1 else f'{count} points lie'} more than {_WILD:g} standard "
        f"deviations from the neighbours, first the one at {readable(first, 'm', 6)}: such spikes "
        "are not normal noise, and shift the fit; leave them out"
    )
    return [FailedCheck("spikes", message)]


def _check_contact(residuals: Residuals, before: NoiseEstimate | None) -> NoiseEstimate:
    """Return the noise, widened by the checks that residuals in contact fail.

    ``before`` is the noise before contact; without one, all residuals give the noise.
    """
    points = np.full(residuals.force.size, True) if before is None else ~residuals.before
    # The points before contact determine the baseline.
    baseline = () if before is None else residuals.baseline
    freedom = max(int(points.sum()) - len(residuals.likelihood.free) + len(baseline), 1)
    scatter = Noise(float(np.sqrt(np.sum(residuals.force[points] ** 2) / freedom)), freedom)
    if before is None:
        before = NoiseEstimate(Noise(max(scatter.deviation, residuals.floor), freedom), ())
    noise, failed, slow = before.noise, list(before.failed), before.slow
    if scatter.exceeds(noise):
        ratio = scatter.deviation / noise.deviation
        finding = f"the residuals are {decimal(ratio, 2)} times the noise before contact"
        failed.append(_misfit("misfit", finding, residuals))
        noise = Noise(scatter.deviation, min(noise.freedom, freedom))
    sums = residuals.binned(_contact_bins(residuals))
    if sums is not None:
        independent = residuals.independent_noise(points)
        usual = independent if slow is None else slow
        usual = Noise(max(usual.deviation, independent.deviation), usual.freedom)
        if wrong := sums.exceeds(usual):
            finding = (
                "the residuals follow a pattern, with sums "
                f"{decimal(np.sqrt(sums.excess(independent)), 2)} times those of independent noise"
            )
            failed.append(_misfit("pattern", finding, residuals))
        # Noise slower than the bins before contact appears in the wider bins in contact.
        if (wrong or slow is not None) and sums.deviation > noise.deviation:
            noise = sums
    return NoiseEstimate(noise, tuple(failed))


def _contact_bins(residuals: Residuals) -> Array:
    """Return a column for each bin of the points in contact, narrow near first touch."""
    share = residuals.depth / float(residuals.depth.max())
    bins = len(_DEPTHS) - 1
    index = np.digitize(share, _DEPTHS[1:-1])
    # A second pass has bins of its own, the shallowest with the rows after contact.
    second = ~residuals.likelihood.first_pass
    index[second] += bins
    index[residuals.before] = -1
    return np.where(index[:, None] == np.arange(2 * bins if second.any() else bins), 1.0, 0.0)


def _misfit(code: str, finding: str, residuals: Residuals) -> FailedCheck:
    point = residuals.parameters[CONTACT_POINT]
    is_free = CONTACT_POINT in residuals.likelihood.free
    fixed = "" if is_free else f", contact from {point:g} m on"
    return FailedCheck(
        code,
        f"in contact {finding}: the model (this indenter, this elastic solid, no adhesion{fixed}) "
        "does not describe the curve; the intervals are widened accordingly",
    )


def check_shape(chi_squared: ChiSquared, best: Minimum) -> tuple[list[str], list[FailedCheck]]:
    """Return the effect of whole shapes in words, as a failed check if they replace the tension.

    They are those that the indenters of curves too deep for them approximate.  The check fails if
    they describe the curves without tension as well as their shallow limits do with a tension that
    they need.
    """
    deep: list[tuple[float, IsShallowLimit, HasForceCurve]] = []
    models = []
    for member, part in chi_squared.curves(best.parameters):
        model, depth = member.force_model, member.deepest(part)
        limit = model.indenter if isinstance(model, ClosedFormModel) else None
        if isinstance(limit, IsShallowLimit) and depth > SHALLOW * limit.radius:
            shape = limit.whole_shape()
            if depth <= shape.depth_limit:
                model = ClosedFormModel(shape)
                deep.append((depth / limit.radius, limit, shape))
        models.append(model)
    if not deep:
        return [], []
    other = chi_squared.with_models(models)
    try:
        minimum = other.minimise(best.parameters)
        fails = _needs_no_tension(other, minimum, chi_squared, best)
    except ConvergenceError:
        return [], []
    if len(models) > 1:
        words = (
            f"{len(deep)} of {len(models)} curves go deeper than {SHALLOW:g} of the radius, and "
            "the shapes that their indenters approximate describe the curves equally well without "
            "tension"
        )
        return [], [FailedCheck("shape", words)] if fails else []
    ((share, *shapes),) = deep
    name, whole = (getattr(shape, "type", type(shape).__name__) for shape in shapes)
    words = (
        f"the depth is {share:.2g} of the radius, and beyond {SHALLOW:g} of it a {name} differs "
        f"from the {whole} that it approximates: with indenter {whole!r} the reduced modulus is "
        f"{readable(np.exp(minimum.parameters[MODULUS]), 'Pa', 4)} and the tension "
        f"{readable(minimum.parameters[TENSION], 'N/m', 3)}"
    )
    if not fails:
        return [words], []
    return [], [
        FailedCheck("shape", f"{words}; it describes the curve equally well without tension")
    ]


def _needs_no_tension(
    other: ChiSquared, minimum: Minimum, chi_squared: ChiSquared, best: Minimum
) -> bool:
    """Return whether ``other`` fits as well without tension where ``chi_squared`` needs one."""
    if TENSION not in chi_squared.free or not best.parameters[TENSION]:
        return False
    gain = chi_squared.without(TENSION, best).chi_squared - best.chi_squared
    if gain <= chdtri(1, 1 - CONFIDENCE):
        return False
    return other.without(TENSION, minimum).chi_squared < best.chi_squared + _ALIKE
