"""The result of a run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pellicle.analysis import Oscillation
from pellicle.arrays import Dataset
from pellicle.contact.caveats import Caveat, Status, by_phrase, from_text
from pellicle.errors import ConfigError, StorageError
from pellicle.files import for_document, is_folder
from pellicle.grid import Grid
from pellicle.units import axis_unit
from pellicle.variables import CAVEATS, COORDINATES, REQUIRED, REQUIRED_OF_LOAD

from . import storage
from .derived import configuration_of
from .path import contact_of, has_load, label_of_step, oscillations_of, path_variables, with_events
from .soundness import check, sound
from .status import first_message, status_of_run
from .step_tables import main_steps

_NO_CONTACT = "0.93"
_MOST_ROWS = 12
"""Rows of the steps in a notebook."""


@dataclass(frozen=True)
class Result:
    """The result of a run: all steps with their fields, and its configuration."""

    dataset: Dataset
    """Dimensions (step, x, y), with units in the attributes of each variable."""

    @property
    def configuration(self) -> dict[str, Any]:
        """The full configuration of the run, in SI floats."""
        return configuration_of(self.dataset)

    @property
    def grid(self) -> Grid:
        """The grid of the fields."""
        return Grid(**self.configuration["grid"])

    @property
    def planned_steps(self) -> int:
        """The number of load steps of the configuration, solved or not."""
        return int(self.dataset.attrs["planned_steps"])

    @property
    def converged(self) -> bool:
        """Whether every step converged."""
        return bool(self.dataset["converged"].all())

    @property
    def path_summary(self) -> dict[str, float]:
        """Numbers of the whole path: events and work where it sticks, the last oscillation.

        The names, units and meanings are those of `pellicle.analysis.PathSummary`, where there is
        an interaction, and of `pellicle.analysis.Oscillation`, where a leg oscillates; events that
        the path does not contain are NaN. It is empty where there is neither.
        """
        return path_variables(self.dataset)

    @property
    def oscillations(self) -> list[Oscillation]:
        """The complex stiffness and dissipation of each oscillation on the path."""
        return oscillations_of(self.dataset)

    def caveats(self) -> Iterator[tuple[int, Caveat]]:
        """Yield number, counted from 1, and caveat of each step that has one, failures included.

        A step may have several, the gravest first.
        """
        data = self.dataset
        for number, text in zip(data["step"].values.tolist(), data[CAVEATS].values, strict=True):
            for caveat in from_text(text):
                yield number, caveat

    def failures(self) -> list[tuple[int, str]]:
        """Return number and status of each step that did not converge."""
        failed = self.dataset.isel(step=~self.dataset["converged"].values)
        return list(
            zip(failed["step"].values.tolist(), map(str, failed["status"].values), strict=True)
        )

    def coarse(self) -> list[tuple[int, str]]:
        """Return number and status of each step whose cells are too coarse."""
        return self._of(Status.COARSE, Status.COARSE_ZONE, Status.COARSE_LOAD, Status.COARSE_LINE)

    def steep(self) -> list[tuple[int, str]]:
        """Return number and status of each step with slopes beyond those of the theory."""
        return self._of(Status.STEEP)

    def warnings(self) -> list[str]:
        """Return a message for each kind of caveat, with the first step that has it."""
        return [*map(first_message, by_phrase(self.caveats()).values())]

    def _of(self, *statuses: Status) -> list[tuple[int, str]]:
        return [(number, c.sentence) for number, c in self.caveats() if c.status in statuses]

    def _repr_html_(self) -> str:
        """Return HTML for a notebook: status, numbers of the steps, all variables folded away."""
        from pellicle.show.notebook import summary

        data, (sentence, _, details) = self.dataset, status_of_run(self)
        many = data.sizes["step"] > _MOST_ROWS
        shortened = data.isel(step=[*range(_MOST_ROWS - 1), -1]) if many else data
        title, text = str(data.attrs["title"] or "Result"), "\n".join((sentence, *details))
        return summary(title, text, main_steps(shortened), details=data._repr_html_())

    def plot(self, variable: str = "pressure", *, step: int | None = None, **options: Any) -> Any:
        """Draw a field of a load step as a map, x to the right and y up; grey without pressure.

        Parameters
        ----------
        variable
            Name of a field, such as pressure, displacement, gap or contact.
        step
            Number of the load step, as in tables and in ``sel``; None for the last.
        **options
            Passed to `xarray.DataArray.plot.pcolormesh`, such as ``ax`` and ``cmap``; values are in
            the unit of the colour bar.

        Returns
        -------
        matplotlib.collections.QuadMesh
            What was drawn.

        Raises
        ------
        ConfigError
            The variable is not a field of the result, or there is no such step.
        """
        fields = [name for name, data in self.dataset.items() if data.dims == ("step", "x", "y")]
        if variable not in fields:
            raise ConfigError(
                f"{variable!r} is not a field; give one of {', '.join(map(str, fields))}",
                "variable",
            )
        numbers = self.dataset["step"].values.tolist()
        if step is not None and step not in numbers:
            raise ConfigError(
                f"{step} is not the number of a load step; give {numbers[0]} to {numbers[-1]}",
                "step",
            )
        index = -1 if step is None else numbers.index(step)
        data = self.dataset.isel(step=index)
        field = data[variable]
        if variable == "pressure":
            field = field.where(contact_of(data) | (field != 0))
        factor, unit = axis_unit([*data["x"].values, *data["y"].values], "m")
        for name in ("x", "y"):
            scaled = data[name] * factor
            field = field.assign_coords({name: scaled.assign_attrs(units=unit, long_name=name)})
        if field.dtype != bool:
            scale, prefixed = axis_unit(field.values, str(field.attrs["units"]))
            field = (field * scale).assign_attrs(field.attrs | {"units": prefixed})
        mesh = field.plot.pcolormesh(x="x", y="y", **options)
        title = label_of_step(self.dataset, index)
        mesh.axes.set(aspect="equal", facecolor=_NO_CONTACT, title=title)
        return mesh

    def save(self, path: str | Path) -> None:
        """Write the result to an HDF5 (NetCDF-4) file.

        Raises
        ------
        StorageError
            The file cannot be written.
        """
        storage.write(self.dataset, Path(path))


def file_of_run(path: Path) -> Path:
    """Return the result file of a run's folder, or the path itself if it is not such a folder."""
    files = sorted(path.glob("*.h5")) if is_folder(path) else []
    if len(files) > 1:
        names = ", ".join(for_document(file.name) for file in files)
        raise StorageError(f"{path}: holds several result files; give one of them: {names}")
    return files[0] if files else path


def load(path: str | Path) -> Result:
    """Return the result in a file that `Result.save` or a run wrote, or in the folder of a run.

    Raises
    ------
    StorageError
        The file does not exist, is damaged, has another schema version, or is not a result.
    """
    dataset = storage.read(file_of_run(Path(path)))
    required = REQUIRED_OF_LOAD if has_load(dataset) else REQUIRED
    if missing := {*COORDINATES, *required} - {*map(str, dataset.variables)}:
        lost = ", ".join(sorted(missing))
        raise StorageError(f"{path}: lacks {lost}, so it is damaged; run it again")
    with sound(Path(path)):
        check(dataset)
    return Result(with_events(dataset))
