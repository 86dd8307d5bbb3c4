"""A measured topography."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from functools import cache, partial
from math import ceil, floor
from typing import Annotated, ClassVar, Literal, Self, get_args

import numpy as np
from numpy.polynomial.legendre import legvander
from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from pellicle.arrays import Array
from pellicle.components import boundary_of_run, pair
from pellicle.errors import ConfigError
from pellicle.schema import InputPath
from pellicle.units import Length, Quantity, readable

from .from_heights import FromHeights, HeightUnit, marks_in
from .sampling import UniformAxis
from .scan import Scan
from .topography_reader import library, read_scan

_Position = Annotated[float, Quantity("m", at_least=0)]
_Level = Literal["none", "mean", "tilt", "curvature"]
_LEVELS: tuple[_Level, ...] = get_args(_Level)
"""In the order of the degree of the subtracted polynomial, which is −1 for none."""
_LARGE, _STEEP = 0.1, 1.0
"""Size [m] and rms slope above which a wrong unit is more likely than such a surface."""
_STEPS = 1.5
"""Step between the mean heights of opposite edges, over the largest of neighbouring lines, above
which a surface is not periodic; 1.2 is the largest of 480 rough ones of 64 lines."""


class Topography(FromHeights):
    """Rough punch measured by a microscope or profilometer, in the unit and size of its file.

    The domain lies within the scan, at its middle or about ``centre``; the part of the scan under
    the domain is filled, levelled and interpolated to the cells.
    Text is read as it is; other formats, and filling, need the extra ``topography``.
    """

    libraries: ClassVar[tuple[str, ...]] = ("SurfaceTopography",)

    type: Literal["topography"] = "topography"
    examples = ({"path": "patch.x3p", "fill": 0.01},)
    path: InputPath = Field(
        title="file", description="text, or a file that SurfaceTopography can read"
    )
    channel: str | None = Field(
        None, description="name of the data set in a file that holds several"
    )
    unit: HeightUnit | None = Field(
        None, description="length that 1 stands for [m], where the file has no unit: 'um'"
    )
    size: Annotated[
        tuple[Length, Length] | None,
        BeforeValidator(pair, json_schema_input_type=Length | tuple[Length, Length] | None),
    ] = Field(
        None,
        description="edge length of the scan [m], if the file does not state it: one, or two "
        "as [along x, along y]",
    )
    centre: tuple[_Position, _Position] | None = Field(
        None,
        description="point of the scan, from its first corner, that lies at the centre of the "
        "domain [m]; the middle of the scan if absent",
    )
    level: _Level | None = Field(
        None,
        description="shape subtracted by least squares: the mean height, which has no effect "
        "since only differences matter, a plane or a paraboloid; if absent, 'tilt', or 'mean' "
        "on a periodic grid, whose edges a plane would part",
    )
    fill: Annotated[float, Quantity("1", at_least=0, below=1)] = Field(
        0.0,
        description="largest share of missing points to fill in, after levelling, "
        "harmonically from their neighbours; 0 refuses any",
    )
    invert: bool = Field(
        False, description="true if the valleys of the scan are what touches, not its peaks"
    )
    _size: tuple[float, float] = PrivateAttr()
    _missing: str = PrivateAttr()

    @model_validator(mode="after")
    def _read(self) -> Self:
        scan = read_scan(self.path, self.channel, self.unit, self.size)
        if min(scan.heights.shape) < 2:
            raise ConfigError(
                f"{self.path} has {scan.heights.shape} points; give 2 or more each way, or, for "
                "line contact, the heights alone as type = 'heights' with grid.points = […, 1]",
                "path",
            )
        self._warn_of_unit(scan)
        self._keep(scan.heights, scan.digest, str(self.path))
        self._size, self._missing = scan.size, scan.missing
        return self

    def _warn_of_unit(self, scan: Scan) -> None:
        reasons = []
        if max(scan.size) > _LARGE:
            reasons.append(f"measures {scan.size[0]:g} × {scan.size[1]:g} m")
        slopes = [0.0]
        for axis, (edge, n) in enumerate(zip(scan.size, scan.heights.shape, strict=True)):
            steps = np.diff(scan.heights, axis=axis)
            steps = steps[np.isfinite(steps)]
            slopes.append(float(np.linalg.norm(steps)) / np.sqrt(max(1, steps.size)) / (edge / n))
        if max(slopes) > _STEEP:
            reasons.append(f"has an rms slope of {max(slopes):.3g}")
        remedy = "export it again with the units of its sides and of its heights"
        if self.unit is not None or self.size is not None:
            remedy = "correct unit or size"
        marks = marks_in(scan.heights, scan.unit, is_steep=max(slopes) > _STEEP)
        if reasons:
            also = "".join(f"; it has {words}" for words in marks)
            warnings.warn(
                f"{self.path} {' and '.join(reasons)}: a unit may be wrong; if so, {remedy}{also}",
                stacklevel=2,
            )
        elif marks:
            warnings.warn(f"{self.path} has {' and '.join(marks)}", stacklevel=2)

    def profile(self, x: Array, y: Array) -> Array:
        """Return the heights at the cells minus the highest one within the domain [m].

        The highest is a cell, or a measured point between coarser cells.
        """
        from scipy.interpolate import make_interp_spline

        axes = UniformAxis.of(x.ravel()), UniformAxis.of(y.ravel())
        pitch = [edge / n for edge, n in zip(self._size, self._values.shape, strict=True)]
        if any(axis.spacing < 0.99 * step for axis, step in zip(axes, pitch, strict=True)):
            warnings.warn(
                f"cells of {_lengths([axis.spacing for axis in axes])} are finer than the points "
                f"of {self.path}, {_lengths(pitch)}: between them the surface is interpolated, "
                "not measured",
                stacklevel=2,
            )
        # Cells, and points of the scan under the domain, as distances from its corner.
        cells = [x.ravel() + self._middle[0], y.ravel() + self._middle[1]]
        window = tuple(self._under(number, axis, pitch[number]) for number, axis in enumerate(axes))
        heights = self._prepared(window)
        points = [
            (np.arange(s.start, s.stop) + 0.5) * d for s, d in zip(window, pitch, strict=True)
        ]
        sampled = heights
        for axis, (positions, cell) in enumerate(zip(points, cells, strict=True)):
            spline = make_interp_spline(positions, sampled, k=min(3, positions.size - 1), axis=axis)
            sampled = spline(np.clip(cell, positions[0], positions[-1]))
        ends = [
            (c[0] - a.spacing / 2, c[-1] + a.spacing / 2) for c, a in zip(cells, axes, strict=True)
        ]
        within = [(p >= low) & (p <= high) for p, (low, high) in zip(points, ends, strict=True)]
        # A peak between cells is no farther above the highest than neighbouring cells differ.
        highest = float(sampled.max())
        hidden = max(float(np.abs(np.diff(sampled, axis=axis)).max()) for axis in (0, 1))
        between = float(heights[np.ix_(*within)].max(initial=highest))
        return sampled - min(between, highest + hidden)

    @property
    def _middle(self) -> tuple[float, float]:
        return self.centre or (self._size[0] / 2, self._size[1] / 2)

    def _under(self, number: int, axis: UniformAxis, pitch: float) -> slice:
        """Return the points of the scan under the domain along one axis."""
        low = axis.first - axis.spacing / 2 + self._middle[number]
        high = low + axis.period
        # The size that an instrument states may or may not include the last point.
        if low < -0.51 * pitch or high > self._size[number] + 0.51 * pitch:
            name, centre = "xy"[number], self._middle[number]
            room = 2 * min(centre, self._size[number] - centre)
            raise ConfigError(
                f"the domain reaches along {name} from {readable(low, 'm')} to "
                f"{readable(high, 'm')} of {self.path}, {_lengths(self._size, 9)} wide; make "
                f"grid.size at most {readable(room, 'm', 9)} along {name}, or move centre",
                "centre" if self.centre else "path",
            )
        first = max(0, floor(low / pitch + 0.01))
        last = min(self._values.shape[number], ceil(high / pitch - 0.01))
        if last - first < 2:
            raise ConfigError(
                f"the domain covers {last - first} points of the scan along {'xy'[number]}; "
                f"enlarge grid.size, whose points are {readable(pitch, 'm', 3)} apart in "
                f"{self.path}",
                "path",
            )
        return slice(first, last)

    def _prepared(self, window: tuple[slice, ...]) -> Array:
        """Return the scan under the domain, filled, levelled and with peaks up [m]."""
        heights = self._values[window]
        measured = np.isfinite(heights)
        is_periodic = boundary_of_run() == "periodic"
        level = self.level or ("mean" if is_periodic else "tilt")
        degree = _LEVELS.index(level) - 1
        fitted = cache(partial(_polynomial, heights, measured))
        if not measured.all():
            share = 1 - float(measured.mean())
            if share > self.fill or not measured.any():
                raise ConfigError(
                    f"{share:.2%} of the points of {self.path} under the domain are "
                    f"{self._missing}, and fill allows {self.fill:.2%}; raise it, or move or "
                    "shrink the domain",
                    "fill",
                )
            # On a tilt, heights that are filled before levelling would be those at the rim.
            trend = fitted(max(degree, 1))
            left = np.ma.masked_array(np.where(measured, heights - trend, 0.0), mask=~measured)
            scan = library(self.path).Topography(left, left.shape)
            # The missing heights solve Laplace's equation.
            filled = scan.interpolate_undefined_data_with_harmonic_function().heights()
            heights = np.where(measured, heights, np.ma.getdata(filled) + trend)
        levelled = heights - fitted(degree)
        if is_periodic:
            next_level: _Level = "tilt" if degree < 1 else "mean"
            rest = heights - fitted(_LEVELS.index(next_level) - 1)
            self._warn_of_seam({level: levelled, next_level: rest})
        return -levelled if self.invert else levelled

    def _warn_of_seam(self, levelled: dict[_Level, Array]) -> None:
        """Warn if opposite edges meet in a step, which the level leaves or makes.

        ``levelled`` are the heights [m] by levels, first those that are pressed. Any two lines of a
        periodic surface may be its edges: their mean heights differ as those of all neighbours do.
        """
        (level, heights), (second, rest) = levelled.items()
        for axis, name in enumerate("xy"):
            step, step_of_rest = (
                float(np.sqrt(np.mean((h.take(0, axis) - h.take(-1, axis)) ** 2)))
                for h in (heights, rest)
            )
            lines = heights.mean(axis=1 - axis)
            is_left = abs(lines[0] - lines[-1]) > _STEPS * np.abs(np.diff(lines)).max()
            is_made = second == "mean" and step - step_of_rest > 0.01 * heights.std()
            if is_left or is_made:
                warnings.warn(
                    f"{self.path} is not periodic along {name} with level = {level!r}: its edges "
                    f"meet in a step of {readable(step, 'm', 2)} (rms), with level = {second!r} of "
                    f"{readable(step_of_rest, 'm', 2)}; take the level that leaves none, or "
                    'press it on grid.boundary = "free"',
                    stacklevel=2,
                )


def _polynomial(heights: Array, measured: Array, degree: int) -> Array:
    """Return the polynomial of a total degree that fits the measured heights best; 0 for −1.

    The basis functions are products of functions of x and of y, and so are their products. A
    general least-squares solver would take twenty times the memory of the heights.
    """
    i, j = np.nonzero(np.add.outer(*2 * [np.arange(degree + 1)]) <= degree)
    x, y = (legvander(np.linspace(-1, 1, n), max(degree, 0)) for n in heights.shape)
    x, y = x[:, i], y[:, j]
    pairs_x, pairs_y = ((b[:, :, None] * b[:, None]).reshape(len(b), -1) for b in (x, y))
    products = np.einsum("py,yp->p", pairs_x.T @ measured.astype(np.float64), pairs_y)
    moments = np.einsum("py,yp->p", x.T @ np.where(measured, heights, 0.0), y)
    # On two points a square and a constant are linearly dependent.
    factors = np.linalg.lstsq(products.reshape(2 * moments.shape), moments)[0]
    return np.asarray((x * factors) @ y.T)


def _lengths(values: Sequence[float], digits: int = 3) -> str:
    """Return two lengths [m] as text, such as ``2 µm × 3 µm``."""
    return " × ".join(readable(value, "m", digits) for value in values)
