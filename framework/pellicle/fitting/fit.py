"""Reduced modulus, tension and contact point of a measured curve, with what is known of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pellicle.components import Executor, HasForceCurve, Indenter
from pellicle.errors import ConfigError
from pellicle.operators import Array

from .curve import Curve, Segment
from .design import advice, undecided
from .estimate import Estimate, of_log, youngs_modulus
from .explained import explain
from .interval import CONFIDENCE, allowed_rise
from .likelihood import MODULUS, OFFSET, POINT, SLOPE, TENSION, Likelihood
from .measured import Calibration, Measured
from .plausible import plausible
from .posed import cleaned, modelled
from .profiled import profiled, widened
from .question import Baseline, Question, question
from .simulated import described
from .simulation import GRID_POINTS
from .written import as_json, write_json


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
    best, without, ends = profiled(likelihood, alone.parameters, rise)
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
    undecided(reduced, tension, likelihood, best.parameters, messages)
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
        advice=advice(likelihood, best.parameters, tension),
        messages=tuple(messages),
        likelihood=likelihood,
        parameters=best.parameters,
        parameters_without_tension=without.parameters,
        rise=rise,
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
