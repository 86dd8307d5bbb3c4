"""What a fit asks: curves on their solid, the model and its rivals."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import chain
from time import perf_counter
from typing import Any

import numpy as np

from pellicle import registry
from pellicle.batch import status_line
from pellicle.components import Component, HasForceCurve, HasLayerForceCurve, Indenter
from pellicle.errors import ConfigError, PellicleError
from pellicle.schema import walk
from pellicle.units import readable

from .config import FitConfig
from .contact.curve import Curve
from .effect import Effect, Solid, quantities
from .estimation.coordinates import CONTACT_POINT
from .files.cleaning import clean
from .files.measurement import Measurement
from .files.missing import MissingInputError
from .files.sources import Source
from .result import Fit, data_of_fit
from .selection.advice import advise
from .selection.calibration import errors
from .selection.neighbour import Neighbour
from .selection.recipe import answer
from .simulated.bead import constants_of, soft_bead
from .simulated.simulation import simulated_curve
from .simulated.solid import solid

_BASELINES = {"none": (), "offset": ("offset",), "slope": ("offset", "slope")}
_SCALES = 1e9
"""Radius over the range of positions, or the reverse, beyond which no contact has a number."""
_REACH = 1.5
"""Depth down to which a force is simulated where the contact is not known, over the range."""
_RATIO = "poissons_ratio"


@dataclass(frozen=True)
class FitProblem:
    """Curves of one solid that are ready to fit; it pickles to workers."""

    config: FitConfig
    names: tuple[str, ...]
    measured: tuple[Measurement, ...]
    """What was read of each curve, and cleaned, with messages of both."""
    curves: tuple[Curve, ...]
    arguments: Mapping[str, Any]
    """Arguments of `answer`: the model, its rivals and what is known."""
    poissons_ratio: float | None
    began: float
    """Value of ``perf_counter`` at the start."""

    def fit(self, *, like: Sequence[Neighbour] = (), progress: bool = False) -> Fit:
        """Return the fit of the curves: one modulus, and what else they share.

        Of a curve, beside others that are ``like`` it.
        """
        config, named = self.config, [*zip(self.names, self.measured, strict=True)]
        with status_line("fitting", progress):
            result = answer(list(self.curves), **self.arguments, like=like)
            left_out = next(
                (rows for measurement in self.measured if (rows := measurement.left_out)), None
            )
            advice = advise(result, left_out, config)
        data = data_of_fit(result, named, advice, self.poissons_ratio, config)
        record = record_of(config, [curve["data"] for curve in data["curves"]], self.began)
        return Fit(data | record, result, config)


def problem(config: FitConfig, sources: Sequence[Source], *, progress: bool = False) -> FitProblem:
    """Return cleaned curves with their indenters, whose forces are simulated if need be."""
    if config.pool and len(sources) < 2:
        raise ConfigError("holds one curve, and a pool needs two; use fit", "curves")
    began, measured, indenters = perf_counter(), [], []
    for source in sources:
        try:
            indenters.append(config.indenter_of(source))
            if isinstance(source.curve, PellicleError):
                raise source.curve
            measured.append(clean(source.curve, config.segment, config.frequencies, config.lag))
        except ConfigError as error:
            if len(sources) == 1 or isinstance(error, MissingInputError):
                raise
            raise source.with_name(error, "; leave it out") from None
    for indenter, curve in zip(indenters, measured, strict=True):
        radius, way = getattr(indenter, "radius", None), float(np.ptp(curve.position))
        if radius and not way / _SCALES < radius < way * _SCALES:
            sizes = readable(radius, "m", 3), readable(way, "m", 3)
            reason = "is {} for positions that vary by {}; check the units".format(*sizes)
            raise ConfigError(reason, "indenter.radius")
    depths = {curve.is_depth for curve in measured}
    if len(depths) > 1:
        raise ConfigError("some are of depths and some of positions; fit them apart", "curves")
    if len(measured) > 1 and CONTACT_POINT in config.fix:
        raise ConfigError(
            "is not shared, each curve has its own; leave it out", "fix.contact_point"
        )
    point = 0.0 if True in depths else config.fix.get(CONTACT_POINT)
    fix = config.fix if point is None else {**config.fix, CONTACT_POINT: point}
    for measurement in measured:
        deepest = float(measurement.position.max())
        if point is not None and not deepest > point:
            reason = f"no position reaches it, the deepest is {readable(deepest, 'm', 4)}"
            raise ConfigError(f"{reason}; give the position of first touch", CONTACT_POINT)
    bodies, layers, ratio = _on_solid(config, indenters, measured, point, progress)
    curves = tuple(
        Curve(
            measured_curve.position,
            measured_curve.force,
            body,
            time=measured_curve.time,
            unloading=measured_curve.unloading,
            stiffness=measured_curve.stiffness,
            touch=point,
            sines=measured_curve.sines,
        )
        for measured_curve, body in zip(measured, bodies, strict=True)
    )
    model = _known(config.model, fix, ratio)
    # What is given leaves nothing to ask.
    known_effects = [effect for effect in model if quantities(type(effect)) and not effect.open]
    baseline = [_effect(name) for name in _BASELINES[config.baseline]]
    # A curve that was made by the polynomial in common use is no sign of a tension.
    of_layers = [layer.model_dump(exclude={"type"}, exclude_none=True) for layer in layers]
    forms = [[_effect("dimitriadis", **fields)] for fields in of_layers if config.rivals]
    arguments = {
        "model": [effect for effect in model if effect not in known_effects],
        "rivals": [r for rival in (*config.rivals, *forms) if (r := _known(rival, fix, ratio))],
        "common": [*known_effects, *baseline, *layers],
        "fix": {name: fix[name] for name in quantities(Solid).keys() & fix.keys()},
        "uncertainty": errors(config.uncertainty),
    }
    names = tuple(source.name for source in sources)
    return FitProblem(config, names, tuple(measured), curves, arguments, ratio, began)


def _on_solid(
    config: FitConfig,
    indenters: Sequence[Indenter | HasForceCurve],
    measured: Sequence[Measurement],
    point: float | None,
    progress: bool,
) -> tuple[list[Any], list[Effect], float | None]:
    """Return what has the force curve of each indenter, a layer beside it, and Poisson's ratio.

    A given contact ``point`` [m] is reached by each curve.
    """
    kernel, ratio, thickness = config.kernel, config.poissons_ratio, config.thickness
    if thickness == "free":
        return [*indenters], [_effect("layer", poissons_ratio=ratio)], ratio
    if isinstance(thickness, float) and ratio is not None:
        # A punch is too wide for the curve at any depth, or at none.
        if ratio >= 0 and all(
            isinstance(body, HasLayerForceCurve) and body.layer_depth_limit(thickness, ratio) > 0
            for body in indenters
        ):
            layer = _effect("layer", thickness=thickness, poissons_ratio=ratio)
            return [*indenters], [layer], ratio
        bonded = {"type": "bonded_layer", "thickness": thickness, "poissons_ratio": ratio}
        kernel = {"type": "coated", "substrate": bonded}
    bodies: list[Any] = []
    for indenter, curve in zip(indenters, measured, strict=True):
        known = isinstance(indenter, HasForceCurve) and indenter.depth_limit > 0
        if kernel is None and known and config.bead is None:
            bodies.append(indenter)
            continue
        if not isinstance(indenter, Indenter):
            reason = "cannot be given with a force curve, which includes its solid"
            raise ConfigError(reason, "kernel")
        deepest = float(curve.position.max())
        reach = _REACH * float(np.ptp(curve.position)) if point is None else deepest - point
        options = {name: getattr(config, name) for name in ("cache", "executor", "grid_points")}
        options["progress"] = progress
        if config.bead is not None:
            modulus, tension = constants_of(config.bead, ratio)
            may = config.fix.get("tension") != 0 and any(
                effect.type_name == "tension" for effect in (*config.model, *chain(*config.rivals))
            )
            skins = tension > 0 or may
            bodies.append(soft_bead(indenter, modulus, tension, reach, skins=skins, **options))
            continue
        of = solid(kernel or "tensed_membrane", config.poissons_ratio)
        ratio = of.poissons_ratio
        bodies.append(simulated_curve(indenter, of, reach, **options))
    return bodies, [], ratio


def _known(
    effects: Sequence[Effect], fix: Mapping[str, float], ratio: float | None
) -> list[Effect]:
    """Return effects with what is fixed, and the solid's ratio; none for a tension fixed at 0."""
    known_effects = []
    for effect in effects:
        own = {name: fix[name] for name in quantities(type(effect)).keys() & fix.keys()}
        if ratio and hasattr(effect, _RATIO) and _RATIO not in effect.model_fields_set:
            own[_RATIO] = max(ratio, 0.0)
        if own.get("tension") != 0:
            known_effects.append(effect.model_copy(update=own))
    return known_effects


def _effect(name: str, **fields: Any) -> Effect:
    return registry().make(Effect, {"type": name, **fields})


def record_of(config: FitConfig, data: Iterable[dict[str, Any]], began: float) -> dict[str, Any]:
    """Return versions, date and wall time [s] of a fit since ``began`` of ``perf_counter``."""
    libraries = {entry["library"] for entry in data if entry["library"]}
    return {
        "versions": registry().all_versions(components_of(config), libraries),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "wall_time": round(perf_counter() - began, 3),
    }


def components_of(config: FitConfig) -> set[type[Component]]:
    """Return the components that a fit uses; of some only the tables are known."""
    fields = walk({"indenter": config.indenter, "kernel": config.kernel})
    types = {value for path, value, _ in fields if path.endswith(".type")}
    families = registry().components.values()
    named = {family[name].component for family in families for name in types & family.keys()}
    objects = config.indenter, config.executor, *config.model, *chain(*config.rivals)
    return named | {type(entry) for entry in objects if isinstance(entry, Component)}
