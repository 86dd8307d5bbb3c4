"""What comes out: the status of a step, what a solver returns, and the result of a run."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import storage
from .errors import StorageError
from .grid import Grid

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from numpy.typing import NDArray


class Status(Enum):
    """How a step ended; the value is what the user is told."""

    CONVERGED = "converged"
    NEAREST_AREA = (
        "converged; the contact area misses the prescribed one by {measure:.1e}, and no load "
        "brings a nearer number of whole cells: more points do"
    )
    COARSE = (
        "converged, but the cells are too coarse for this contact, which covers {cells} of them: "
        "force, depth and area may be far off; use more points, or a smaller grid.size"
    )
    NOT_FINITE = (
        "the pressure became NaN or infinite; check the kernel's compliance and the profile for "
        "extreme values"
    )
    NEGATIVE_PRESSURE = "the solver returned a negative pressure, {measure:.1e} of the highest"
    CONTACT_RESIDUAL = (
        "the surface misses the indenter inside the contact by {measure:.1e} of the indenter's "
        "height range there, over the tolerance {tolerance:.1e}; {remedy}"
    )
    PENETRATION = (
        "the surface penetrates the indenter outside the contact by {measure:.1e} of the height "
        "range in contact, over the tolerance {tolerance:.1e}; {remedy}"
    )
    COMPLEMENTARITY = (
        "pressure acts across a gap: complementarity {measure:.1e} is over the tolerance "
        "{tolerance:.1e}; {remedy}"
    )
    LOAD = "the force misses the prescribed one by {measure:.1e}, over {tolerance:.1e}; {remedy}"
    AREA = (
        "the contact area misses the prescribed one by {measure:.1e}, over {tolerance:g}; {remedy}"
    )
    STIFFNESS = (
        "the contact stiffness is not known: its displacement misses by {measure:.1e}, over the "
        "tolerance {tolerance:.1e}; loosen solver.tolerance, or leave loading.stiffness out"
    )
    CONTACT_AT_EDGE = (
        "the contact reaches the edge of the domain, where the indenter does not end, so force "
        "and area are wrong; enlarge grid.size = {size} or prescribe less than {prescribed}"
    )

    def says(self, message: str) -> bool:
        """Whether this is what a user was told by ``message``, up to its first figure."""
        return message.startswith(self.value.partition("{")[0])


class Stop(Enum):
    """Why a solver stopped; the value is the remedy if the result is not good enough."""

    DONE = "tighten the solver's own criterion"
    ITERATION_LIMIT = "the limit of iterations was reached: raise solver.max_iterations"
    ROUND_OFF = "the tolerance is below round-off here: loosen solver.tolerance"
    STALLED = (
        "the solver makes no progress any more, and not because of round-off: try another solver, "
        "another load, or cells that resolve the heights"
    )
    NOT_FINITE = "the iteration met a value that is not finite"


@dataclass(frozen=True)
class Solution:
    """What a solver returns for one step."""

    pressure: NDArray[np.float64]
    """Contact pressure ≥ 0 [Pa], of the grid's shape."""
    iterations: int
    """Steps of the solver's outermost loop."""
    stop: Stop = Stop.DONE
    """Why it ended."""


@dataclass(frozen=True)
class Result:
    """The result of a run: all steps, their fields, and where they came from."""

    dataset: xr.Dataset
    """Dimensions (step, x, y); units in the attributes of each variable."""

    @property
    def configuration(self) -> dict[str, Any]:
        """The full configuration that was run, SI floats."""
        return json.loads(self.dataset.attrs["configuration"])  # type: ignore[no-any-return]

    @property
    def grid(self) -> Grid:
        """The cells that the fields lie on."""
        return Grid(**self.configuration["grid"])

    @property
    def converged(self) -> bool:
        """Whether every step converged."""
        return bool(self.dataset["converged"].all())

    def failures(self) -> list[tuple[int, str]]:
        """Return the index of each step that did not converge, with its status."""
        flags, messages = self.dataset["converged"].values, self.dataset["status"].values
        return [(i, str(messages[i])) for i, converged in enumerate(flags) if not converged]

    def coarse(self) -> list[tuple[int, str]]:
        """Return the index of each step whose contact the cells do not resolve, with its status."""
        messages = map(str, self.dataset["status"].values)
        return [(i, message) for i, message in enumerate(messages) if Status.COARSE.says(message)]

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        return self.dataset._repr_html_()

    def save(self, path: str | Path) -> None:
        """Write the result to an HDF5 (NetCDF-4) file.

        Raises
        ------
        StorageError
            The file cannot be written.
        """
        storage.write(self.dataset, Path(path))


def said_of_steps(steps: Sequence[tuple[int, str]]) -> str:
    """Return which steps, counted from 1, and what is said of the first of them."""
    (index, message), *others = steps
    return f"step {index + 1}{f' and {len(others)} more' if others else ''}: {message}"


def load(path: str | Path) -> Result:
    """Return the result in a file that `Result.save` or the output ``hdf5`` wrote.

    Raises
    ------
    StorageError
        No such file, not a result, damaged, or of another schema version.
    """
    dataset = storage.read(Path(path))
    if missing := _ALWAYS - {*map(str, dataset.variables)}:
        raise StorageError(
            f"{path}: lacks {', '.join(sorted(missing))}, so it is damaged; run it again"
        )
    return Result(dataset)


_ALWAYS = {"step", "x", "y", "pressure", "displacement", "gap", "contact"} | {
    *("depth", "force", "contact_area", "iterations", "converged", "status")
}
"""Variables without which there is no result, whatever the version that wrote it."""
