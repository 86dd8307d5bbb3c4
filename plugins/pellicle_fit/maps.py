"""Fits of the curves of a force map."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from pellicle.errors import ConfigError

from .config import FitConfig
from .files.sources import Curves, SourceStream
from .many import fit_sources

if TYPE_CHECKING:
    import xarray as xr


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
    ConfigError, PluginError
        An argument is not allowed, or the curves are not those of one map.
    StorageError
        The folder cannot be used.
    """
    config = FitConfig.merged(config, **options)
    folder = None if directory is None else Path(directory)
    fits = fit_sources(config, SourceStream(config.files(curves)), folder, progress=progress)
    if len(fits.maps) != 1:
        reason = "; ".join(fits.notes) or "their files do not say where curves were measured"
        raise ConfigError(
            f"hold {len(fits.maps)} force maps ({reason}); give one, or use fit_many", "curves"
        )
    (images,) = fits.maps.values()
    return images
