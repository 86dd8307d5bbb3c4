"""Read measured curves without fitting them."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

from pellicle.errors import ConfigError, PellicleError

from .columns import Calibration
from .curve import Curve, Segment
from .readers import SourceStream, gather


def read_curves(
    path: str | Path, *, segment: Segment = "both", **calibration: Any
) -> dict[str, Curve]:
    """Return the curves of a file, a folder, a pattern or a table of files by their names.

    Position, force and time are in SI; a curve draws itself with `Curve.plot`.

    Parameters
    ----------
    path
        As the curves of `fit_many`.
    segment
        Segment of the files of instruments that label segments; both are all rows.
    **calibration
        Options of `fit` that say how files are read: ``spring_constant``, ``sensitivity``,
        ``speed``, ``columns``.

    Returns
    -------
    dict[str, Curve]
        In order; a curve that cannot be read is left out with a warning.

    Raises
    ------
    ConfigError
        No curve can be read, or an argument is not allowed.
    StorageError
        A folder or a list of files cannot be read.
    """
    curves: dict[str, Curve] = {}
    errors: list[PellicleError] = []
    for source in SourceStream(gather(path, segment, Calibration(**calibration), {})):
        if isinstance(source.curve, Curve):
            curves[source.name] = source.curve
        else:
            errors.append(source.named(ConfigError(source.reason(source.curve))))
    if not curves:
        raise ConfigError("\n".join(map(str, errors)))
    for error in errors:
        warnings.warn(str(error), stacklevel=2)
    return curves
