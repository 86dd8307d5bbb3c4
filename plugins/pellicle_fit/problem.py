"""A fit problem: one curve, the force model to fit to it, and the parameters that vary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pellicle.errors import ConfigError, PellicleError

from .config import FIXABLE, FitConfig
from .files.cleaning import clean
from .files.measurement import Measurement, Segment
from .files.sources import Source
from .models.force_model import ForceModel
from .models.simulation import Simulation, simulate
from .parameters import CONTACT_POINT, OFFSET, SLOPE, Coordinates
from .statistics.initial_guess import BEFORE
from .statistics.likelihood import Likelihood

_FIXED_BASELINE = {"none": (OFFSET, SLOPE), "offset": (SLOPE,), "slope": ()}


@dataclass(frozen=True)
class FitProblem:
    """A curve and the model to fit to it; it pickles to workers."""

    name: str
    """File, and label in the file."""
    curve: Measurement
    model: ForceModel | Simulation
    fixed: Coordinates
    """Parameters that are not fitted."""
    poissons_ratio: float | None
    segment: Segment = "approach"
    compare: bool = False
    """Whether rivals of a tension are compared in full."""

    def simulated(self, config: FitConfig, *, progress: bool) -> FitProblem:
        """Return the problem with a force model, simulated if need be."""
        if not isinstance(self.model, Simulation):
            return self
        position = self.curve.position
        span = float(np.ptp(position))
        point = self.fixed.get(CONTACT_POINT)
        reach = (1 + BEFORE) * span if point is None else float(position.max()) - point
        # If no position reaches contact, the fit itself reports it.
        model = simulate(
            *self.model,
            reach if reach > 0 else span,
            cache=config.cache,
            executor=config.executor,
            grid_points=config.grid_points,
            progress=progress,
        )
        return replace(self, model=model)

    def likelihood(self) -> Likelihood:
        """Return the likelihood of the curve, with a noise as large as the largest force."""
        assert not isinstance(self.model, Simulation), "its force curve is not simulated yet"
        curve, noise = self.curve, float(np.max(np.abs(self.curve.force)))
        whole = Likelihood(
            curve.position,
            curve.force,
            self.model,
            noise,
            (),
            curve.stiffness,
            curve.time,
            self.segment,
        )
        return replace(whole, free=tuple(p for p in whole.parameters if p not in self.fixed))


def problems(config: FitConfig, sources: Sequence[Source]) -> list[FitProblem | PellicleError]:
    """Return the problem of each source, or the error of its curve.

    Raises
    ------
    ConfigError, PluginError
        The configuration does not allow a fit of one of the sources.
    """
    results: list[FitProblem | PellicleError] = []
    for source in sources:
        curve = source.curve
        if isinstance(curve, PellicleError):
            results.append(curve)
            continue
        try:
            model = config.force_model(source.fields)
        except ConfigError as error:
            raise error if len(sources) == 1 else source.named(error) from None
        fixed: Coordinates = {CONTACT_POINT: 0.0} if curve.is_depth else {}
        fixed |= {FIXABLE[name]: FIXABLE[name].coordinate(v) for name, v in config.fix.items()}
        fixed |= dict.fromkeys(_FIXED_BASELINE[config.baseline], 0.0)
        elastic_solid = model.solid if isinstance(model, Simulation) else model
        ratio = getattr(elastic_solid, "poissons_ratio", config.poissons_ratio)
        try:
            curve = clean(curve, config.segment)
            results.append(
                FitProblem(source.name, curve, model, fixed, ratio, config.segment, config.compare)
            )
        except ConfigError as error:
            results.append(error)
    return results
