"""The grid: a rectangle of surface divided into equal rectangular cells."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial
from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field
from scipy.fft import fftfreq, rfftfreq

from .arrays import Array
from .checks import whole_number
from .schema.model import Model
from .units import Length

Boundary = Literal["free", "periodic"]

_of_run: ContextVar[Grid | None] = ContextVar("grid of the run", default=None)


@contextmanager
def grid_of_run(grid: Grid | None) -> Iterator[None]:
    """Let components created or asked within this context know the grid of their run."""
    token = _of_run.set(grid)
    try:
        yield
    finally:
        _of_run.reset(token)


def shape_of_run() -> tuple[int, int] | None:
    """Return the shape of the grid of the run being created; None outside of one.

    The shape of a file is compared with it before the file is read into memory.
    """
    grid = _of_run.get()
    return None if grid is None else grid.shape


def boundary_of_run() -> Boundary | None:
    """Return the boundary of the grid on which a component is asked; None outside of a run."""
    grid = _of_run.get()
    return None if grid is None else grid.boundary


def pair(value: object) -> object:
    """Return a single value twice, for both directions; a pair or None as it is."""
    return value if value is None or isinstance(value, (list, tuple)) else (value, value)


_Whole = Annotated[int, Field(ge=1)]
_Points = Annotated[
    int, BeforeValidator(partial(whole_number, unit="cells"), json_schema_input_type=_Whole)
]


class Grid(Model):
    """A rectangle of cells centred at the origin; fields have their values at cell centres."""

    points: Annotated[
        tuple[_Points, _Points],
        BeforeValidator(pair, json_schema_input_type=_Whole | tuple[_Whole, _Whole]),
    ] = Field(
        title="number of cells",
        description="number of cells: one whole number, or two as [along x, along y]",
    )
    size: Annotated[
        tuple[Length, Length],
        BeforeValidator(pair, json_schema_input_type=Length | tuple[Length, Length]),
    ] = Field(
        title="domain size",
        description="edge length of the domain [m]: one, or two as [along x, along y]",
    )
    boundary: Boundary = Field(
        "free",
        description='"free": an isolated contact on an infinite surface; '
        '"periodic": the domain repeats in both directions',
    )

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells along x and y, the shape of every field."""
        return self.points

    @property
    def spacing(self) -> tuple[float, float]:
        """Edge lengths of a cell [m]."""
        return self.size[0] / self.points[0], self.size[1] / self.points[1]

    @property
    def cell_size(self) -> float:
        """Longest edge of a cell [m], along directions with more than one cell if there are any.

        A line of cells resolves what varies along it, however wide it is.
        """
        along = [edge for edge, n in zip(self.spacing, self.points, strict=True) if n > 1]
        return max(along or self.spacing)

    @property
    def cell_area(self) -> float:
        """Area of a cell [m²]."""
        return self.spacing[0] * self.spacing[1]

    @property
    def area(self) -> float:
        """Area of the domain [m²]."""
        return self.size[0] * self.size[1]

    def coarsened(self) -> Grid:
        """Return the grid of the same domain with half as many cells each way, rounded up."""
        nx, ny = self.points
        return self.model_copy(update={"points": (-(-nx // 2), -(-ny // 2))})

    def coordinates(self) -> tuple[Array, Array]:
        """Return x of shape (nx, 1) and y of shape (1, ny) of the cell centres [m]."""
        x, y = (
            (np.arange(n, dtype=np.float64) - (n - 1) / 2) * spacing
            for n, spacing in zip(self.points, self.spacing, strict=True)
        )
        return x[:, None], y[None, :]

    def wavenumbers(self) -> tuple[Array, Array]:
        """Return q_x of shape (nx, 1) and q_y of shape (1, ny//2 + 1) [rad/m].

        Their order is that of ``scipy.fft.rfft2`` of a field.
        """
        (nx, ny), (dx, dy) = self.points, self.spacing
        qx, qy = 2 * np.pi * fftfreq(nx, dx), 2 * np.pi * rfftfreq(ny, dy)
        return qx[:, None], qy[None, :]
