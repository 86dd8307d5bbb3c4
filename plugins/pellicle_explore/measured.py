"""A measured force curve that lies over the computed one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import pellicle as pl
from pellicle.errors import ConfigError


def read(path: Path) -> pl.Curve:
    """Return the only force curve of a file, without the rows that lack a number."""
    curve, *others = pl.read_curves(path, segment="approach").values()
    if others:
        raise ConfigError(f"holds {1 + len(others)} curves; give a file with one", "--curve")
    rows = np.isfinite(curve.position) & np.isfinite(curve.force)
    if np.unique(curve.position[rows]).size < 2:
        raise ConfigError("has no two positions with a force; give a curve that moves", "--curve")
    return replace(curve, position=curve.position[rows], force=curve.force[rows])


def touch(curve: pl.Curve) -> float:
    """Return the share of the positions at which the force has risen by 5 % of its range."""
    position = (curve.position - curve.position.min()) / np.ptp(curve.position)
    start = np.median(curve.force[position <= 0.1])
    above = curve.force > start + 0.05 * (curve.force.max() - start)
    return float(position[above].min(initial=1.0))
