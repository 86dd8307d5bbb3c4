"""Fits of one measured curve, and of several of one solid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pellicle import registry
from pellicle.batch import status_line
from pellicle.components import HasForceCurve, Indenter
from pellicle.errors import ConfigError, PellicleError
from pellicle.units import Quantity

from .config import FREE, TENSION, UNCERTAIN, FitConfig
from .curve import Curve
from .effect import Effect, quantities
from .explanation import Solid
from .files.cleaning import clean
from .files.measurement import Measurement
from .files.sources import Curves, Source
from .objective import CONTACT_POINT
from .recipe import answer
from .record import Stopwatch, data_of
from .result import Fit, Member
from .sentences import advised
from .simulated.body import body_of, layer_of, layer_table
from .simulated.simulation import Simulation

_BASELINES = {"none": (), "offset": ("offset",), "slope": ("offset", "slope")}
_EFFECTS = {
    "spring_constant": ("spring", "spring_error"),
    "sensitivity": ("sensitivity", "sensitivity_error"),
    "radius": ("size", "size_error"),
}
"""Effect and quantity that an uncertainty is of."""
_REACH = 1.5
"""Depth down to which a force is simulated where the contact is not known, over the range."""
_RATIO = "poissons_ratio"


def fit(
    position: ArrayLike | str | Path | None = None,
    force: ArrayLike | None = None,
    *,
    depth: ArrayLike | None = None,
    time: ArrayLike | None = None,
    config: FitConfig | str | Path | None = None,
    progress: bool = False,
    **options: Any,
) -> Fit:
    """Fit reduced modulus, tension and contact point to one measured curve.

    The solid is a half-space under tension unless a model or a kernel is given; the contact is
    frictionless.  What else bends force curves is compared with it.  Errors of the force are
    assumed to be normal, with equal variance at all points; the intervals have a confidence of
    95 %.

    An indenter that has a force curve of its own (paraboloid, sphere, cone, flat_punch) is fitted
    at once.  Any other indenter, or any on another kernel, first needs a study of some 150 runs,
    which is kept in ``cache`` and serves all curves of the same proportions.

    Parameters
    ----------
    position, force
        Position of the indenter [m], growing into the solid, and force [N], both of shape (n,).
        With the option ``spring_constant`` [N/m], position is that of the cantilever's base less
        its deflection, so that the noise of the deflection is in both.  Instead of both, a file:
        ``pl.fit("bead.csv", …)``.
    depth
        Depth [m] instead of position: the contact point is then fixed at 0.
    time
        Time [s] of each row, in order; without it the option ``speed`` [m/s] gives a constant one.
    config
        A configuration or its TOML file.  Without position and force, the curve that it names is
        fitted.
    progress
        Show the progress of a study and of the fit on a terminal or in a notebook.
    **options
        Fields of `FitConfig`, which replace those of ``config``, and fields of the indenter:
        ``indenter="paraboloid", radius="5 um", model=["tension"], rivals=["brush"]``.

    Raises
    ------
    ConfigError, PluginError
        The curve cannot be fitted, or an argument is not allowed.
    ConvergenceError, StorageError
        A study failed, or its folder cannot be used.
    """
    if isinstance(position, (str, Path)):
        file, position = Path(position), None
        if file.suffix.lower() == ".toml" and config is None:
            config = file
        else:
            options["curves"] = file
    config = FitConfig.merged(config, **options)
    curves = None
    positions = [values for values in (position, depth) if values is not None]
    if positions or force is not None or not config.curves:
        if len(positions) != 1:
            raise ConfigError("give either position or depth")
        if force is None:
            raise ConfigError("is missing; give the force [N] at each position", "force")
        curves = {"": (positions[0], force) if time is None else (positions[0], force, time)}
    source, *others = config.sources(curves)
    if others:
        count = 1 + len(others)
        raise ConfigError(f"names {count} curves; use fit_many or fit_pooled", "curves")
    if depth is not None and isinstance(source.curve, Measurement):
        source = source._replace(curve=replace(source.curve, is_depth=True))
    return fitted(config, [source], progress=progress)


def fit_pooled(
    curves: Curves | None = None,
    *,
    config: FitConfig | str | Path | None = None,
    progress: bool = False,
    **options: Any,
) -> Fit:
    """Fit one reduced modulus and one tension to several curves together.

    Each curve has its own contact point, baseline and noise. Curves of small and of large contacts
    tell modulus and tension apart better than any of them alone.

    Parameters
    ----------
    curves
        As for `fit_many`.
    progress
        Show the progress of studies and of the fit on a terminal or in a notebook.
    config, **options
        As for `fit_many`, but a contact point cannot be fixed.

    Raises
    ------
    ConfigError
        A curve cannot be read or fitted, there is only one, or an argument is not allowed.
    StorageError
        A folder cannot be read.
    """
    config = FitConfig.merged(config, pool=True, **options)
    return fitted(config, config.sources(curves), progress=progress)


@dataclass(frozen=True)
class Problem:
    """Curves of one solid that are ready to fit; it pickles to workers."""

    config: FitConfig
    members: tuple[Member, ...]
    fix: Mapping[str, float]
    layers: tuple[Effect, ...]
    uncertainty: tuple[Effect, ...]
    poissons_ratio: float | None
    watch: Stopwatch

    def fit(self, *, progress: bool = False) -> Fit:
        """Return the fit of the curves: one modulus, and what else they share.

        Raises
        ------
        ConfigError, PluginError, ConvergenceError
            As for `fit`.
        """
        model, kept, rivals = _effects(self.config, self.poissons_ratio)
        with status_line("fitting", progress):
            found = answer(
                [member.curve for member in self.members],
                model,
                rivals,
                kept=(*kept, *self.layers),
                fix={name: self.fix[name] for name in quantities(Solid).keys() & self.fix.keys()},
                uncertainty=self.uncertainty,
                full=self.config.compare,
            )
            advice = advised(found)
        record = self.watch.record(self.config, [member.data for member in self.members])
        return Fit(found, self.members, advice, self.poissons_ratio, self.config, record)


def fitted(config: FitConfig, sources: Sequence[Source], *, progress: bool = False) -> Fit:
    """Return the fit of the curves of one solid; it raises what `fit` does."""
    return problem(config, sources, progress=progress).fit(progress=progress)


def problem(config: FitConfig, sources: Sequence[Source], *, progress: bool = False) -> Problem:
    """Return cleaned curves with their indenters, whose forces are simulated if need be.

    Raises
    ------
    ConfigError, PluginError, ConvergenceError, StorageError
        As for `fit`.
    """
    if config.pool and len(sources) < 2:
        raise ConfigError("holds one curve, and a pool needs two; use fit", "curves")
    watch, measured, indenters = Stopwatch(), [], []
    for source in sources:
        try:
            if isinstance(source.curve, PellicleError):
                raise source.curve
            indenters.append(config.indenter_with(source.fields))
            measured.append(clean(source.curve, config.segment))
        except ConfigError as error:
            raise error if len(sources) == 1 else source.named(error, "; leave it out") from None
    fix, depths = dict(config.fix), {curve.is_depth for curve in measured}
    if len(depths) > 1:
        raise ConfigError("some are of depths and some of positions; fit them apart", "curves")
    if len(measured) > 1 and CONTACT_POINT in fix:
        raise ConfigError(
            "is not shared, each curve has its own; leave it out", "fix.contact_point"
        )
    if True in depths:
        fix[CONTACT_POINT] = 0.0
    bodies, layers, ratio = _on_solid(config, indenters, measured, progress)
    members = tuple(
        Member(
            source.name,
            Curve(one.position, one.force, body, one.time, one.unloading, one.stiffness),
            one.messages,
            data_of(one, config),
        )
        for source, one, body in zip(sources, measured, bodies, strict=True)
    )
    uncertain = tuple(_uncertain(config, measured, indenters))
    return Problem(config, members, fix, tuple(layers), uncertain, ratio, watch)


def _on_solid(
    config: FitConfig,
    indenters: Sequence[Indenter | HasForceCurve],
    measured: Sequence[Measurement],
    progress: bool,
) -> tuple[list[Any], list[Effect], float | None]:
    """Return what has the force curve of each indenter, a layer beside it, and Poisson's ratio."""
    kernel, ratio, thickness = config.kernel, config.poissons_ratio, config.thickness
    if thickness == FREE:
        layer = registry().make(Effect, {"type": "layer", _RATIO: ratio})
        return [*indenters], [layer], ratio
    if isinstance(thickness, float) and ratio is not None:
        kernel = layer_table(ratio, thickness)
    if kernel is not None:
        layers = [layer_of(indenter, kernel, ratio) for indenter in indenters]
        if layers[0] is not None and all(layers):
            return [*indenters], [layers[0]], layers[0].poissons_ratio
    bodies: list[Any] = []
    for indenter, curve in zip(indenters, measured, strict=True):
        body = body_of(indenter, kernel, ratio)
        if isinstance(body, Simulation):
            ratio, span = body.solid.poissons_ratio, float(np.ptp(curve.position))
            point = 0.0 if curve.is_depth else config.fix.get(CONTACT_POINT)
            reach = _REACH * span if point is None else float(curve.position.max()) - point
            body = body.curve(
                # If no position reaches contact, the fit itself reports it.
                reach if reach > 0 else span,
                cache=config.cache,
                executor=config.executor,
                grid_points=config.grid_points,
                progress=progress,
            )
        bodies.append(body)
    return bodies, [], ratio


def _effects(
    config: FitConfig, ratio: float | None
) -> tuple[list[Effect], list[Effect], list[list[Effect]]]:
    """Return the model, what all explanations have beside it, and the rivals.

    A tension that is fixed at 0 is in none of them; an effect whose quantities are all given, in
    all, for it leaves nothing to ask.
    """
    fix = config.fix

    def known(effects: Sequence[Effect]) -> list[Effect]:
        found = []
        for effect in effects:
            own = {name: fix[name] for name in quantities(type(effect)).keys() & fix.keys()}
            if hasattr(effect, _RATIO) and _RATIO not in effect.model_fields_set and ratio:
                own[_RATIO] = max(ratio, 0.0)
            if fix.get(TENSION) != 0 or effect.type_name != TENSION:
                found.append(effect.model_copy(update=own))
        return found

    model = known(config.model)
    kept = [effect for effect in model if quantities(type(effect)) and not effect.open]
    baseline = [registry().make(Effect, {"type": name}) for name in _BASELINES[config.baseline]]
    rivals = [rival for rival in map(known, config.rivals) if rival]
    return [effect for effect in model if effect not in kept], kept + baseline, rivals


def _uncertain(
    config: FitConfig, measured: Sequence[Measurement], indenters: Sequence[object]
) -> list[Effect]:
    """Return the effects that stand for the uncertainties of the calibration."""
    effects: list[Effect] = []
    known = {
        "spring_constant": {curve.stiffness for curve in measured},
        "sensitivity": {curve.origin.sensitivity for curve in measured},
        "radius": {getattr(indenter, "radius", None) for indenter in indenters},
    }

    def one(name: str, asked: str, remedy: str) -> float:
        value, *others = known[name]
        if value is None or others:
            which = "differs between curves" if others else "is not known"
            raise ConfigError(f"the {name} {which}; {remedy}", f"uncertainty.{asked}")
        return float(value)

    for name, value in config.uncertainty.items():
        if isinstance(value, str):
            value = Quantity(UNCERTAIN[name])(value) / one(name, name, "give a share such as 5 %")
        effect, quantity = _EFFECTS[name]
        weighed = {quantity: {"value": 0.0, "deviation": value}}
        effects.append(registry().make(Effect, {"type": effect, **weighed}))
    return effects
