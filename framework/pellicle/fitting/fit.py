"""Reduced modulus, tension and contact point of a measured curve, with what is known of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from pellicle.components import Executor, HasForceCurve, Indenter
from pellicle.errors import ConfigError, PellicleError

from .curves.columns import Calibration, Measured
from .curves.curve import Segment
from .curves.sources import Source
from .models.force_model import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION
from .models.simulation import GRID_POINTS
from .plausible import plausible
from .posed import Posed, likelihood, posed
from .problem import Baseline
from .result import Answer, doubt
from .statistics.checks import fit_single
from .statistics.design import advice, undecided
from .statistics.initial_guess import initial_guesses
from .statistics.likelihood import Likelihood, Minimum, best_minimum
from .statistics.profile import Estimate, chi_squared_threshold, profile_likelihood
from .status import Report, ignore, status


@dataclass(frozen=True)
class Fit(Answer):
    """What a curve says of the solid, and how sure it is."""

    contact_point: Estimate
    """Position of first touch [m]."""
    offset: Estimate
    """Force of the baseline at the first position [N]."""
    slope: Estimate
    """Slope of the baseline [N/m]."""
    noise: float
    """Standard deviation of the force [N]."""
    noise_from: str
    """What it was estimated from."""
    points: int
    """Rows that were used."""
    likelihood: Likelihood
    """The curve and its χ²."""

    def model(self) -> dict[str, Any]:
        """Return indenter and kernel that were fitted with, as JSON has them.

        A kernel is there only if its force curve was simulated, without modulus and tension.
        """
        return self.likelihood.force_model.description()

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        return super().to_dict() | {
            "model": self.model(),
            "noise": {"value": self.noise, "unit": "N", "from": self.noise_from},
            "points": self.points,
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
        Show how far a study and the fit are, on a terminal.

    Raises
    ------
    ConfigError, PluginError
        The curve cannot be fitted, or an argument is not allowed.
    ConvergenceError, StorageError
        A study did not come to its end.
    """
    if (position is None) == (depth is None):
        raise ConfigError("give either position or depth")
    if force is None:
        raise ConfigError("is missing; give the force [N] at each position", "force")
    stiffness = Calibration.of(spring_constant).spring_constant
    measured = Measured(force, position, depth, stiffness=stiffness)  # type: ignore[arg-type]
    options = {
        "kernel": kernel,
        "poissons_ratio": poissons_ratio,
        "fix": fix,
        "baseline": baseline,
        "segment": segment,
    }
    return fit_source(
        Source("", measured, fields),
        indenter,
        options,
        cache=cache,
        executor=executor,
        grid_points=grid_points,
        progress=progress,
    )


def fit_source(
    source: Source,
    indenter: str | Mapping[str, Any] | Indenter | HasForceCurve,
    options: Mapping[str, Any],
    **study: Any,
) -> Fit:
    """Return the fit of a source; ``options`` are those of `question`, ``study`` of `simulate`.

    Raises
    ------
    PellicleError
        As for `fit`, or why the source could not be read.
    """
    (found,) = posed([source], indenter, options)
    if isinstance(found, PellicleError):
        raise found
    modelled = found.modelled(**study)
    with status(study.get("progress", False)) as report:
        return fitted(modelled, report)


def fitted(posed: Posed, report: Report = ignore) -> Fit:
    """Return the fit of a curve by an indenter that has a force curve.

    ``report`` is called with what the fit is doing.

    Raises
    ------
    ConfigError
        The curve cannot be fitted.
    """
    report("least squares")
    single = fit_single(likelihood(posed), posed.asked.fixed)
    chi_squared, threshold = single.likelihood, chi_squared_threshold(single.freedom)
    profile = profile_likelihood(
        chi_squared,
        chi_squared.minimise(single.parameters),
        threshold,
        chi_squared.free,
        partial(_without_tension, chi_squared),
        report,
    )
    best = profile.best.parameters
    point, modulus, tension = map(profile.estimate, (CONTACT_POINT, MODULUS, TENSION))
    return Fit(
        reduced_modulus=modulus,
        tension=tension,
        poissons_ratio=posed.asked.poissons_ratio,
        chi_squared=profile.best.chi_squared,
        chi_squared_without_tension=profile.without_tension.chi_squared,
        advice=advice(chi_squared, best, modulus, tension),
        messages=(
            *posed.curve.messages,
            *single.messages,
            *(check.message for check in single.failed_checks),
            *profile.messages,
            *plausible(posed, point.value, modulus.value, tension.value),
            *undecided(modulus, tension, chi_squared, best),
        ),
        parameters=best,
        parameters_without_tension=profile.without_tension.parameters,
        rise=threshold,
        failed_checks=single.failed_checks,
        doubt=doubt(single.failed_checks),
        contact_point=point,
        offset=profile.estimate(OFFSET),
        slope=profile.estimate(SLOPE),
        noise=chi_squared.noise,
        noise_from=single.noise_from,
        points=posed.curve.force.size,
        likelihood=chi_squared,
    )


def _without_tension(likelihood: Likelihood, best: Minimum) -> Minimum:
    """Return the least χ² without tension, near the best and near the best of a scan."""
    start = best.parameters | {TENSION: 0.0}
    fixed = replace(likelihood, free=tuple(p for p in likelihood.free if p != TENSION))
    return best_minimum(fixed, (start, *initial_guesses(fixed, start)[:1]))
