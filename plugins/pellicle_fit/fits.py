"""Fits of one measured curve, and of several of one solid."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from pellicle.errors import ConfigError

from .config import FitConfig
from .files.sources import Curves
from .problem import problem
from .result import Fit


def fit(
    position: ArrayLike | str | Path | None = None,
    force: ArrayLike | None = None,
    *,
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

    An indenter that has a force curve of its own (a body of revolution, a sharp pyramid) is fitted
    at once.  Any other indenter, or any on another kernel, first needs a study of some 150 runs,
    which is kept in ``cache`` and serves all curves of about the same depth.

    Parameters
    ----------
    position, force
        Position of the indenter [m], growing into the solid, and force [N], both of shape (n,).
        With the option ``spring_constant`` [N/m], position is that of the cantilever's base less
        its deflection, so that the noise of the deflection is in both.  Of a depth, fix the
        contact point: ``fix={"contact_point": 0}``.  Instead of both, a file:
        ``pl.fit("bead.csv", …)``.
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
        options["curves"], position = position, None
    config = FitConfig.merged(config, **options)
    curves = None
    if position is not None or force is not None or not config.curves:
        if position is None or force is None:
            raise ConfigError("give positions [m] and the force [N] at each, or a file")
        curves = {"": (position, force) if time is None else (position, force, time)}
    source, *others = config.sources(curves)
    if others:
        raise ConfigError(f"names {1 + len(others)} curves; use fit_many or fit_pooled", "curves")
    return problem(config, [source], progress=progress).fit(progress=progress)


def fit_pooled(
    curves: Curves | None = None,
    *,
    config: FitConfig | str | Path | None = None,
    progress: bool = False,
    **options: Any,
) -> Fit:
    """Fit one reduced modulus and one tension to several curves together.

    Each curve has its own contact point, baseline and noise.

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
    ConfigError, PluginError, ConvergenceError, StorageError
        As in `fit`, or there is only one curve.
    """
    config = FitConfig.merged(config, pool=True, **options)
    sources = [*config.sources(curves)]
    return problem(config, sources, progress=progress).fit(progress=progress)
