"""A fit problem: one curve, the indenter and solid to fit to it, and the parameters that vary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pellicle.components import Component, HasForceCurve, Indenter
from pellicle.errors import ConfigError, PellicleError

from .config import FIXABLE, FitConfig
from .curves.curve import Curve, clean
from .curves.readers import Source
from .models.force_model import CONTACT_POINT, OFFSET, SLOPE, Coordinates, tension_model
from .models.simulation import simulate
from .models.solid import Solid, lengths
from .statistics.initial_guess import BEFORE
from .statistics.likelihood import Likelihood

_FIXED_BASELINE = {"none": (OFFSET, SLOPE), "offset": (SLOPE,), "slope": ()}
_PLAUSIBLE_DEPTH = (1e-3, 1.0)
"""Depth over radius."""
_PLAUSIBLE_MODULUS = (1.0, 1e12)
_PLAUSIBLE_TENSION = 10.0


@dataclass(frozen=True)
class FitProblem:
    """A curve and the model to fit to it; it pickles to workers."""

    name: str
    """File, and label in the file."""
    curve: Curve
    indenter: Indenter | HasForceCurve
    solid: Solid | None
    """The solid to simulate; None if the indenter has a force curve."""
    fixed: Coordinates
    """Parameters that are not fitted."""
    poissons_ratio: float | None

    def simulated(self, config: FitConfig, *, progress: bool) -> FitProblem:
        """Return the problem with an indenter that has a force curve, simulated if need be."""
        if self.solid is None:
            return self
        position = self.curve.position
        span = float(np.ptp(position))
        point = self.fixed.get(CONTACT_POINT)
        reach = (1 + BEFORE) * span if point is None else float(position[-1]) - point
        # If no position reaches contact, the fit itself reports it.
        curve = simulate(
            self.indenter,  # type: ignore[arg-type]
            self.solid,
            reach if reach > 0 else span,
            cache=config.cache,
            executor=config.executor,
            grid_points=config.grid_points,
            progress=progress,
        )
        return replace(self, indenter=curve, solid=None)

    def likelihood(self) -> Likelihood:
        """Return the likelihood of the curve, with a noise as large as the largest force."""
        position, force = self.curve.position, self.curve.force
        model = tension_model(self.indenter)  # type: ignore[arg-type]
        noise = float(np.max(np.abs(force)))
        whole = Likelihood(position, force, model, noise, (), self.curve.stiffness)
        return replace(whole, free=tuple(p for p in whole.parameters if p not in self.fixed))

    def check_plausible(self, point: float, modulus: float, tension: float) -> list[str]:
        """Return warnings of implausible results, such as a wrong unit or radius causes.

        Raises
        ------
        ConfigError
            The depth is beyond that of the indenter's force curve.
        """
        messages = []
        model: Any = tension_model(self.indenter)  # type: ignore[arg-type]
        depth = float(self.curve.position[-1]) - point
        shape = model.indenter
        radius = next(iter(lengths(shape)), None) if isinstance(shape, Component) else None
        if depth > model.depth_limit:
            raise ConfigError(
                f"the depth reaches {depth:.3g} m, and the curve of this indenter ends at "
                f"{model.depth_limit:.3g} m; is the radius right? If so, leave out the deepest "
                "part",
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
            messages.append(
                f"a tension of {tension:.3g} N/m is not plausible: are the units right?"
            )
        return messages


def problems(config: FitConfig, sources: Sequence[Source]) -> list[FitProblem | PellicleError]:
    """Return the problem of each source, or the error of its curve.

    Raises
    ------
    ConfigError, PluginError
        The configuration does not allow a fit of one of the sources.
    """
    results: list[FitProblem | PellicleError] = []
    for source in sources:
        if isinstance(source.curve, PellicleError):
            results.append(source.curve)
            continue
        try:
            problem = _problem(config, source, source.curve)
        except ConfigError as error:
            raise error if len(sources) == 1 else source.named(error) from None
        try:
            results.append(replace(problem, curve=clean(source.curve, config.segment)))
        except ConfigError as error:
            results.append(error)
    return results


def _problem(config: FitConfig, source: Source, curve: Curve) -> FitProblem:
    indenter = config.indenter_with(source.fields)
    solid = config.solid_under(indenter)
    fixed: Coordinates = {CONTACT_POINT: 0.0} if curve.is_depth else {}
    fixed |= {FIXABLE[name]: FIXABLE[name].coordinate(value) for name, value in config.fix.items()}
    fixed |= dict.fromkeys(_FIXED_BASELINE[config.baseline], 0.0)
    return FitProblem(
        source.name,
        curve,
        indenter,
        solid,
        fixed,
        config.poissons_ratio if solid is None else solid.poissons_ratio,
    )
