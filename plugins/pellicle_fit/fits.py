"""Fits of one measured curve, and of several of one solid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from pellicle import registry
from pellicle.arrays import Array
from pellicle.batch import status_line
from pellicle.errors import ConfigError, PellicleError
from pellicle.units import Quantity

from .config import FREE, TENSION, UNCERTAIN, FitConfig
from .curve import Curve
from .effect import Effect, quantities
from .explanation import Solid
from .files.cleaning import clean
from .files.measurement import Measurement
from .files.sources import Curves, Source
from .recipe import answer
from .record import Stopwatch, data_of
from .result import Fit, Member
from .sentences import advised

_BASELINES = {"none": (), "offset": ("offset",), "slope": ("offset", "slope")}


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
        curves = {"": (positions[0], force)}
    source, *others = config.sources(curves)
    if others:
        count = 1 + len(others)
        raise ConfigError(f"names {count} curves; use fit_many or fit_pooled", "curves")
    if isinstance(source.curve, Measurement):
        # `clean` checks the array.
        clock = source.curve.time if time is None else cast("Array", time)
        is_depth = source.curve.is_depth or depth is not None
        source = source._replace(curve=replace(source.curve, is_depth=is_depth, time=clock))
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


def fitted(config: FitConfig, sources: Sequence[Source], *, progress: bool = False) -> Fit:
    """Return the fit of the curves of one solid: one modulus, and what else they share.

    Raises
    ------
    ConfigError, PluginError, ConvergenceError, StorageError
        As for `fit`.
    """
    if config.pool and len(sources) < 2:
        raise ConfigError("holds one curve, and a pool needs two; use fit", "curves")
    watch, members, cleaned = Stopwatch(), [], []
    for source in sources:
        try:
            measured = source.curve
            if isinstance(measured, PellicleError):
                raise measured
            measured = clean(measured, config.segment)
            curve = _curve(measured, config, source)
        except ConfigError as error:
            raise error if len(sources) == 1 else source.named(error, "; leave it out") from None
        data = data_of(measured, config)
        members.append(Member(source.name, curve, measured.messages, data))
        cleaned.append(measured)
    curves, fix = [member.curve for member in members], dict(config.fix)
    if any(measured.is_depth for measured in cleaned):
        if not all(measured.is_depth for measured in cleaned):
            raise ConfigError("of some curves are depths, of others not; fit them apart", "curves")
        fix["contact_point"] = 0.0
    elif len(curves) > 1 and "contact_point" in fix:
        raise ConfigError(
            "is not shared, each curve has its own; leave it out", "fix.contact_point"
        )
    uncertain = _uncertain(config, cleaned[0], curves[0])
    model, kept, rivals = _effects(config)
    solid: dict[str, float | str] = {k: fix[k] for k in quantities(Solid).keys() & fix.keys()}
    with status_line("fitting", progress):
        found = answer(
            curves,
            model,
            rivals,
            kept=kept,
            fix=solid,
            uncertainty=uncertain,
            full=config.compare,
        )
        advice = advised(found)
    record = watch.record(config, [member.data for member in members])
    return Fit(found, tuple(members), advice, config.poissons_ratio, config, record)


def _curve(measured: Measurement, config: FitConfig, source: Source) -> Curve:
    """Return the curve that fits work on, of a cleaned measurement."""
    position, force, time = measured.position, measured.force, measured.time
    if config.segment == "retract":
        position, force, time = position[::-1], force[::-1], None if time is None else time[::-1]
    moves_out = np.ones(position.size, bool) if config.segment == "retract" else None
    body = config.body(source.fields)
    return Curve(position, force, body, time, moves_out, measured.stiffness)


def _effects(
    config: FitConfig,
) -> tuple[tuple[Effect, ...], tuple[Effect, ...], list[tuple[Effect, ...]]]:
    """Return the model, what all explanations have beside it, and the rivals.

    A tension that is fixed at 0 is in none of them, and what is fixed otherwise in all.
    """
    fix, ratio = config.fix, config.poissons_ratio
    absent = fix.get(TENSION) == 0

    def known(effects: Sequence[Effect]) -> tuple[Effect, ...]:
        found = []
        for effect in effects:
            own = {name: fix[name] for name in quantities(type(effect)).keys() & fix.keys()}
            if "poissons_ratio" not in effect.model_fields_set and ratio is not None:
                own |= {name: ratio for name in ("poissons_ratio",) if hasattr(effect, name)}
            if not (absent and effect.type_name == TENSION):
                found.append(effect.model_copy(update=own) if own else effect)
        return tuple(found)

    model, kept = known(config.model), []
    # What is given leaves nothing to ask.
    kept += [e for e in model if quantities(type(e)) and not e.open]
    kept += [registry().make(Effect, {"type": name}) for name in _BASELINES[config.baseline]]
    if config.thickness is not None:
        layer: dict[str, Any] = {"type": "layer", "poissons_ratio": ratio}
        if config.thickness != FREE:
            layer["thickness"] = config.thickness
        kept.append(registry().make(Effect, layer))
    rivals = [known(rival) for rival in config.rivals]
    return tuple(e for e in model if e not in kept), tuple(kept), [r for r in rivals if r]


def _uncertain(config: FitConfig, measured: Measurement, curve: Curve) -> list[Effect]:
    """Return the effects that stand for the uncertainties of the calibration."""
    references = {
        "spring_constant": measured.stiffness,
        "sensitivity": measured.origin.sensitivity,
        "radius": getattr(curve.indenter, "radius", None),
    }
    tables = []
    for name, value in config.uncertainty.items():
        if isinstance(value, str):
            reference = references[name]
            if reference is None:
                raise ConfigError(
                    "is a quantity, and there is none to compare it with; give a share",
                    f"uncertainty.{name}",
                )
            value = Quantity(UNCERTAIN[name])(value) / reference
        effect, quantity = {
            "spring_constant": ("spring", "spring_error"),
            "sensitivity": ("compliance", "compliance"),
            "radius": ("size", "size_error"),
        }[name]
        if name == "sensitivity":
            # Where the sensitivity is off by ε, the tip is not where it seems, by ε F/k.
            if measured.stiffness is None:
                raise ConfigError("needs a spring constant", "uncertainty.sensitivity")
            value /= measured.stiffness
        tables.append({"type": effect, quantity: {"value": 0.0, "deviation": value}})
    return [registry().make(Effect, table) for table in tables]
