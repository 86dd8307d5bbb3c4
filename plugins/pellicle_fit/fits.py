"""Fits of one measured curve, of several of one solid, of many, and of a force map."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xarray as xr
from numpy.typing import ArrayLike

from pellicle.errors import ConfigError

from .config import FitConfig
from .files.sources import Curves
from .many import fit_sources
from .population.fits import table
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
    at once.  Any other indenter, or any on another kernel, first needs studies of some 30 runs,
    which are kept in ``cache`` and serve all curves of about the same depth.

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


def fit_many(
    curves: Curves | None = None,
    *,
    config: FitConfig | str | Path | None = None,
    directory: str | Path | None = None,
    progress: bool = True,
    **options: Any,
) -> xr.Dataset:
    """Fit each of many curves on its own and return a table with a row for each.

    Parameters
    ----------
    curves
        A folder; a file, which may hold several curves; a pattern such as ``"beads/*.csv"``; a
        table that lists files, with a header such as ``file,radius [um]``; several of these; or
        position [m] and force [N] of each curve by its name, ``{"first": (position, force)}``.
        Those of the configuration if not given.
    directory
        Folder for the table, as ``fits.h5``, ``fits.csv`` and ``fits.json``, and a file for each
        curve in ``curves``, with all of its fit. One that it contains already is not repeated.
    progress
        Show a bar on a terminal or in a notebook; elsewhere, a line for each curve.
    config, **options
        As for `fit`.  A list for a field of the indenter, for spring_constant or for sensitivity
        has a value for each file: ``radius=["5 um", "20 um"]``.

    Returns
    -------
    xarray.Dataset
        Over ``curve``: each quantity as value, ``_low`` and ``_high`` (NaN: open), with noise, χ²,
        the verdict and the messages. ``status`` is ``fitted``, or why there is no fit.

    Raises
    ------
    ConfigError, PluginError
        An argument is not allowed, or there is no curve; nothing was fitted.
    StorageError
        The folder cannot be used.
    """
    config = FitConfig.merged(config, **options)
    return table(fit_sources(config, config.sources(curves), directory, progress=progress).rows)


def fit_map(
    curves: Curves | None = None,
    *,
    config: FitConfig | str | Path | None = None,
    directory: str | Path | None = None,
    progress: bool = True,
    **options: Any,
) -> xr.Dataset:
    """Fit each curve of a force map on its own and return an image of each parameter.

    Parameters
    ----------
    curves
        The file of a force map; or a table that lists files and where they were measured, with a
        header such as ``file,x [um],y [um]``.
    directory, progress, config, **options
        As for `fit_many`, whose files are written too, and the images as well in ``maps``.

    Returns
    -------
    xarray.Dataset
        Over ``y`` and ``x`` [m]: each parameter as value, ``_low`` and ``_high``, with the contact
        point as ``contact_height``, and the quality of each fit.  NaN where a curve is missing,
        could not be fitted or was rejected, and at open ends of intervals.

    Raises
    ------
    ConfigError, PluginError, StorageError
        As in `fit_many`, or the curves are not those of one map.
    """
    config = FitConfig.merged(config, **options)
    fits = fit_sources(config, config.sources(curves), directory, progress=progress)
    if len(fits.maps) != 1:
        reason = "; ".join(fits.notes) or "their files do not say where curves were measured"
        raise ConfigError(
            f"hold {len(fits.maps)} force maps ({reason}); give one, or use fit_many", "curves"
        )
    (images,) = fits.maps.values()
    return images
