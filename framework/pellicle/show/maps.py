"""Maps of fields over the domain, packed for a page, in frames that are shown in turn."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.grid import Grid
from pellicle.units import axis_unit

_NOTHING = 0xFFFF
_PIXELS = 3_000_000
_FEWEST = 32


class Field(NamedTuple):
    """A field that is mapped."""

    name: str
    unit: str
    """SI unit."""
    colours: str = "viridis"
    """A colour map of matplotlib."""
    blank: bool = False
    """Whether cells where it is 0 stay empty."""
    power: float = 1.0
    """Exponent applied to the values before colours are assigned: 0.5 separates small ones."""
    centred: bool = False
    """Whether the colours reach as far below 0 as above it."""


class _Packed(NamedTuple):
    low: float
    high: float
    data: str


@dataclass(frozen=True)
class Frame:
    """Maps of one load step or of one run."""

    label: str
    grid: Grid
    factors: tuple[int, int]
    """Number of cells in a pixel along x and y."""
    shape: tuple[int, int]
    packed: tuple[_Packed, ...]
    note: str = ""
    """A sentence shown with the maps."""


def side(points: int, maps: int) -> int:
    """Return the number of pixels along each side of a map, at most ``points``.

    All maps together have at most three million, which keeps a page to some megabytes.
    """
    return min(points, max(_FEWEST, int(sqrt(_PIXELS / max(maps, 1)))))


def frame(
    label: str, grid: Grid, fields: Sequence[Array], points: int, empty: Collection[int] = ()
) -> Frame:
    """Return fields of the grid's shape as maps of at most ``points`` pixels a side.

    A pixel is the mean of the finite values in a block of cells; without any it is empty. In the
    fields with an index in ``empty`` pixels of 0 are empty too: packed beside negative values, 0 is
    rounded.
    """
    nx, ny = (-(-n // points) for n in grid.shape)
    coarse = [_means(field, (nx, ny)) for field in fields]
    for index in empty:
        coarse[index][coarse[index] == 0] = np.nan
    packed = tuple(map(_pack, coarse))
    return Frame(label, grid, (nx, ny), (-(-grid.shape[0] // nx), -(-grid.shape[1] // ny)), packed)


@dataclass(frozen=True)
class Maps:
    """Maps of the same fields in several frames, zoomed together, each in colours of its range."""

    caption: str
    noun: str
    """Noun for a frame, such as ``"load step"``."""
    fields: Sequence[Field]
    frames: Sequence[Frame]
    begin: int = 0
    """Index of the frame that is shown first."""

    @property
    def remark(self) -> str:
        """A sentence on the size of the pixels, empty if they are the cells."""
        factors = {frame.factors for frame in self.frames} - {(1, 1)}
        if not factors:
            return ""
        most = " × ".join(map(str, max(factors)))
        same = len({frame.factors for frame in self.frames}) == 1
        return f"Each pixel is the mean over {'' if same else 'up to '}{most} cells."

    @property
    def data(self) -> dict[str, Any]:
        """The input of the page's script; lengths and values are in the units that it names."""
        import matplotlib

        sizes = np.array([frame.grid.size for frame in self.frames])
        length, length_unit = axis_unit(sizes / 2, "m")
        fields, scales = [], []
        for number, field in enumerate(self.fields):
            ends = [(frame.packed[number].low, frame.packed[number].high) for frame in self.frames]
            scale, unit = axis_unit(np.array(ends), field.unit)
            scales.append(scale)
            colours = matplotlib.colormaps[field.colours](np.arange(256), bytes=True)[:, :3]
            told = field._asdict() | {"unit": unit, "si": field.unit, "per_si": scale}
            # The 256 colours of the map, three bytes for each.
            fields.append(told | {"colours": base64.b64encode(colours.tobytes()).decode()})
        return {
            "unit": length_unit,
            "per_metre": length,
            "fields": fields,
            "frames": [
                {
                    "label": frame.label,
                    "note": frame.note,
                    "shape": frame.shape,
                    "size": [edge * length for edge in frame.grid.size],
                    "pixel": [
                        edge * factor * length
                        for edge, factor in zip(frame.grid.spacing, frame.factors, strict=True)
                    ],
                    "fields": [
                        {"low": p.low * scale, "high": p.high * scale, "data": p.data}
                        for p, scale in zip(frame.packed, scales, strict=True)
                    ],
                }
                for frame in self.frames
            ],
        }


def _means(field: Array, factors: tuple[int, int]) -> Array:
    """Return the mean of the finite values in each block; NaN where there is none."""
    (nx, ny), (fx, fy) = field.shape, factors
    padded = np.pad(field, ((0, -nx % fx), (0, -ny % fy)), constant_values=np.nan)
    blocks = padded.reshape(padded.shape[0] // fx, fx, padded.shape[1] // fy, fy)
    finite = np.isfinite(blocks)
    count = finite.sum((1, 3))
    total = np.where(finite, blocks, 0.0).sum((1, 3))
    means: Array = np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)
    return means


def _pack(values: Array) -> _Packed:
    """Return values in steps of 1/65534 of their range, as differences of neighbours.

    High and low bytes are stored apart: they compress well where the field is smooth.
    """
    finite = np.isfinite(values)
    low, high = (values[finite].min(), values[finite].max()) if finite.any() else (0.0, 0.0)
    shares = np.where(finite, values - low, 0.0) / ((high - low) or 1.0)
    codes = np.where(finite, np.rint(shares * (_NOTHING - 1)), _NOTHING).astype(np.uint16).ravel()
    steps = np.diff(codes, prepend=np.uint16(0))
    planes = np.stack([steps >> 8, steps & 0xFF]).astype(np.uint8).tobytes()
    return _Packed(float(low), float(high), base64.b64encode(zlib.compress(planes, 9)).decode())
