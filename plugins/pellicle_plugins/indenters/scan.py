"""A measured surface, and the data sets of its file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from math import inf
from pathlib import Path
from typing import NamedTuple

from pellicle.arrays import Array
from pellicle.errors import ConfigError
from pellicle.units import Quantity

Edge = tuple[float, str | None]
"""An edge length and its unit; None for that of the heights."""


class Scan(NamedTuple):
    """A measured surface."""

    heights: Array
    """Heights [m] along x, then y; NaN where a point is missing."""
    size: tuple[float, float]
    """Edge lengths [m]."""
    digest: str
    """SHA-256 of the file."""
    unit: float
    """Length that 1 in the file stands for [m]."""
    missing: str
    """Words on the missing points."""


class Channel(NamedTuple):
    """A data set as its file states it."""

    name: str
    unit: str | None
    """Unit of its values; None if it is not stated."""
    is_height: bool
    is_areal: bool
    edges: Sequence[Edge]
    """Two edge lengths, as `known_edges` returns them."""
    read: Callable[[], Array]
    """Return the values along x, then y; NaN where a point is missing."""
    missing: str = "missing"
    """Words on the missing points."""


def known_edges(edges: Sequence[Edge]) -> Sequence[Edge]:
    """Return the edge lengths of a surface; none where a program that did not know them wrote 0."""
    return edges if len(edges) == 2 and all(0 < edge < inf for edge, _ in edges) else ()


def metres(unit: str) -> float | None:
    """Return a unit of length [m]; None for any other."""
    with suppress(ValueError):
        return Quantity("m")(f"1 {unit}")
    return None


def channel_of(channels: Sequence[Channel], name: str | None, path: Path) -> Channel:
    """Return the channel of heights with a name; the first of them if it is None."""
    channels = sorted(channels, key=lambda channel: not channel.is_height)
    names = dict.fromkeys(repr(channel.name) for channel in channels if channel.is_height)
    heights = ", ".join(names) or "none"
    by_name = {channel.name: channel for channel in channels}
    if name is not None and name not in by_name:
        raise ConfigError(
            f"{name!r} is not in {path}; its channels of heights are: {heights}", "channel"
        )
    channel = channels[0] if name is None else by_name[name]
    if not channel.is_height:
        raise ConfigError(
            f"{channel.name!r} of {path} is in {channel.unit}, not heights; its channels of "
            f"heights are: {heights}",
            "channel",
        )
    if not channel.is_areal:
        raise ConfigError(
            f"{path} is a profile along a line, and contact needs an area; give an areal scan, or, "
            "for line contact, the heights alone as type = 'heights' with grid.points = […, 1]",
            "path",
        )
    return channel


def height_scale(channel: Channel, unit_length: float | None, path: Path) -> float:
    """Return the length that a value of 1 stands for [m], as stated or else as the user says."""
    if channel.unit is None:
        if unit_length is None:
            raise ConfigError(
                f"is missing, and {path} does not state the unit of its heights; give the "
                "length that 1 stands for: '1 um'",
                "unit",
            )
        return unit_length
    if unit_length is not None:
        raise ConfigError(f"{path} states its own unit, {channel.unit}; leave this out", "unit")
    if (scale := metres(channel.unit)) is None:
        raise ConfigError(f"{path} is in {channel.unit}, which is not a unit of length", "path")
    return scale


def edge_lengths(
    channel: Channel, lengths: tuple[float, float] | None, scale: float, path: Path
) -> tuple[float, float]:
    """Return the edge lengths [m], as stated or else ``lengths``; a value of 1 is ``scale`` [m]."""
    if not channel.edges:
        if lengths is None:
            raise ConfigError(
                f"is missing, and {path} does not state it; give the edge lengths of the scan, "
                "such as ['80 um', '60 um']",
                "size",
            )
        return lengths
    size = []
    for edge, unit in channel.edges:
        if (in_metres := metres(unit) if unit else scale) is None:
            raise ConfigError(
                f"{path} states its size in {unit!r}, which is not a unit of length; in its "
                "header, write decimals with a point and units such as um",
                "path",
            )
        size.append(edge * in_metres)
    x, y = size
    if lengths is not None:
        raise ConfigError(f"{path} states its own size, {x:g} × {y:g} m; leave this out", "size")
    return x, y
