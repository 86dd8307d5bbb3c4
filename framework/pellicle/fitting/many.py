"""Fits of many curves by an executor, and the table with a row for each."""

from __future__ import annotations

import csv
import hashlib
import json
import pickle
from collections.abc import Iterable, Mapping
from contextlib import closing
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pellicle.components import Component, Say
from pellicle.components.calls import outcomes_of
from pellicle.errors import PellicleError
from pellicle.files import atomic_write, check_writable
from pellicle.results import storage
from pellicle.results.variables import header
from pellicle.runs.progress import StudyProgress

from .config import FitConfig
from .curves.readers import Curves, Source
from .fit import fit_problem
from .problem import FitProblem, problems
from .record import Record, Stopwatch, data_of
from .result import write_json

if TYPE_CHECKING:
    import xarray as xr

FITTED = "fitted"
FAILED = "failed: "
_NOT_RUN = "not run"
_WITHOUT_EFFECT = {"curves", "per_file", "pool", "contact_points", "executor", "cache"}
"""Fields of a configuration that do not change the fit of a curve."""
_MEASURED = {"spring_constant": "N/m", "sensitivity": "m/V", "poissons_ratio": "1"}
"""Numbers in the data of a row, and their units."""
_BYTES_PER_POINT = 2000
"""Memory of a fit, approximately."""

Row = dict[str, Any]
"""JSON data of one curve: its name, ``status``, and what `Fit.to_dict` returns."""


@dataclass(frozen=True)
class FitTask:
    """The fit of one curve; it pickles to workers."""

    row: int
    problem: FitProblem
    path: Path | None
    """File that keeps the fit."""

    @property
    def name(self) -> str:
        """Name in a progress bar."""
        return self.problem.name

    @property
    def memory(self) -> int:
        """Estimated peak memory of the fit [bytes]."""
        return _BYTES_PER_POINT * self.problem.curve.force.size


class ManyFits(NamedTuple):
    """The fits of many curves."""

    rows: list[Row]
    files: tuple[Path, ...]
    resumed: int
    """Number of fits that an earlier call had finished."""

    @property
    def failed(self) -> int:
        """Number of curves that could not be fitted."""
        return sum(row["status"].startswith(FAILED) for row in self.rows)

    def to_dict(self) -> dict[str, Any]:
        """Return the fits as JSON data."""
        return {"curves": self.rows}


def fit_many(
    curves: Curves | None = None,
    *,
    config: FitConfig | str | Path | None = None,
    directory: str | Path | None = None,
    progress: bool = True,
    **options: Any,
) -> xr.Dataset:
    """Fit each of many curves on its own and return a table with a row for each.

    A curve that cannot be fitted does not stop the others: its row has the reason.

    Parameters
    ----------
    curves
        A folder; a file, which may hold several curves; a pattern such as ``"beads/*.csv"``; a
        table that lists files, with a header such as ``file,radius [um]``; several of these; or
        position [m] and force [N] of each curve by its name, ``{"first": (position, force)}``.
        Those of the configuration if not given.
    directory
        Folder for the table, as ``fits.h5``, ``fits.csv`` and ``fits.json``, and a file for each
        curve in ``curves``. A fit that it contains already is not repeated.
    progress
        Show a bar on a terminal; without one, a line for each curve.
    config, **options
        As for `fit`.  A list for a field of the indenter, for spring_constant or for sensitivity
        has a value for each file: ``radius=["5 um", "20 um"]``.

    Returns
    -------
    xarray.Dataset
        Over ``curve``: each parameter as value, ``_low``, ``_high`` (NaN: open) and ``_bound``,
        with noise, χ² and the messages. ``status`` is ``fitted``, or why there is no fit.

    Raises
    ------
    ConfigError, PluginError
        An argument is not allowed, or there is no curve; nothing was fitted.
    StorageError
        The folder cannot be used.
    """
    config = FitConfig.merged(config, **options)
    folder = None if directory is None else Path(directory)
    return table(fit_sources(config, config.sources(curves), folder, progress=progress).rows)


def fit_sources(
    config: FitConfig, sources: list[Source], directory: Path | None, *, progress: bool
) -> ManyFits:
    """Fit each curve that is not fitted yet, and write the files.

    If interrupted, the table has all fits that were finished.
    """
    if directory is not None:
        check_writable(directory / "fits.h5")
    rows: list[Row] = [{"curve": source.name, "status": _NOT_RUN} for source in sources]
    tasks: list[FitTask] = []
    watch, posed = Stopwatch(), problems(config, sources)
    for number, problem in enumerate(posed):
        try:
            if isinstance(problem, PellicleError):
                raise problem
            rows[number]["data"] = data_of(problem.curve, config)
            path = None
            if directory is not None:
                name = f"{_identity(config, sources[number], problem)[:16]}.json"
                path = directory / "curves" / name
                if (earlier := _read(path)) is not None:
                    rows[number] |= earlier | {"status": FITTED}
                    continue
            tasks.append(FitTask(number, problem.simulated(config, progress=progress), path))
        except PellicleError as error:
            rows[number]["status"] = _failure(error, sources[number])
    resumed = sum(row["status"] == FITTED for row in rows)
    files: tuple[Path, ...] = ()
    try:
        with (
            StudyProgress(len(sources), len(sources) - len(tasks), progress) as bar,
            closing(outcomes_of(config.executor, work, tasks, bar.report, dict)) as outcomes,
        ):
            for task, outcome in outcomes:
                if isinstance(outcome, Exception):
                    rows[task.row]["status"] = _failure(outcome, sources[task.row])
                else:
                    rows[task.row] |= outcome | {"status": FITTED}
                    if task.path is not None:
                        write_json(outcome, task.path)
                status = str(rows[task.row]["status"])
                bar.finished(task, status, status != FITTED)
    finally:
        if directory is not None:
            files = _write(rows, config, watch.record(config, posed), directory)
    return ManyFits(rows, files, resumed)


def work(task: FitTask, say: Say) -> dict[str, Any]:
    """Fit a curve in a worker."""
    return fit_problem(task.problem).to_dict()


def _identity(config: FitConfig, source: Source, problem: FitProblem) -> str:
    """Return a hash that is equal for fits with equal results."""
    options = config.model_dump(mode="json", exclude=_WITHOUT_EFFECT, fallback=str)
    curve = problem.curve
    of_curve = (dict(source.fields), curve.is_depth, curve.stiffness, curve.messages)
    digest = hashlib.sha256(repr((version("pellicle"), options, of_curve)).encode())
    if not isinstance(config.indenter, (Component, Mapping)):
        digest.update(pickle.dumps(config.indenter))
    for values in (curve.position, curve.force):
        digest.update(values.tobytes())
    return digest.hexdigest()


def _read(path: Path) -> Row | None:
    """Return the fit that a file stores; None if it stores none."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return content if isinstance(content, dict) else None


def _failure(error: Exception, source: Source) -> str:
    """Return the status of a curve that could not be fitted."""
    reason = "; ".join(source.reason(error).splitlines()) or "no reason given"
    kind = "" if isinstance(error, PellicleError) else f"{type(error).__name__}: "
    return f"{FAILED}{kind}{reason}"


def table(rows: list[Row]) -> xr.Dataset:
    """Return rows as a dataset over ``curve``; NaN where there is no number."""
    import xarray as xr

    def texts(values: Iterable[str]) -> tuple[str, Any]:
        return "curve", np.array(list(values), dtype=object)

    def numbers(values: Iterable[float | None], unit: str = "1") -> tuple[str, Any, dict[str, str]]:
        return "curve", np.array(list(values), dtype=float), {"units": unit}

    columns: dict[str, Any] = {"status": texts(row["status"] for row in rows)}
    units = {
        name: value["unit"]
        for row in rows
        for name, value in row.items()
        if isinstance(value, dict) and "unit" in value
    }
    for name, unit in units.items():
        columns[name] = numbers((row.get(name, {}).get("value") for row in rows), unit)
        for end in ("low", "high", "bound"):
            column = numbers((row.get(name, {}).get(end) for row in rows), unit)
            if np.isfinite(column[1]).any():
                columns[f"{name}_{end}"] = column
    for name in ("points", "chi_squared", "tension_needed"):
        columns[name] = numbers(row.get(name) for row in rows)
    for name in ("delta_chi_squared", "delta_aic"):
        columns[name] = numbers(row.get("without_tension", {}).get(name) for row in rows)
    for name in ("comparison", "advice"):
        columns[name] = texts(row.get(name, "") for row in rows)
    checks = [[check["code"] for check in row.get("failed_checks", ())] for row in rows]
    columns["failed_checks"] = texts(map("; ".join, checks))
    data = [row.get("data", {}) for row in rows]
    for name, unit in _MEASURED.items():
        columns[name] = numbers((entry.get(name) for entry in data), unit)
    for name in ("segment", "baseline", "file", "sha256"):
        columns[name] = texts(entry.get(name) or "" for entry in data)
    roles = [entry.get("columns", {}).items() for entry in data]
    columns["columns"] = texts("; ".join(f"{r} = {c}" for r, c in items) for items in roles)
    columns["messages"] = texts("; ".join(row.get("messages", ())) for row in rows)
    return xr.Dataset(columns, {"curve": texts(row["curve"] for row in rows)})


def _write(rows: list[Row], config: FitConfig, record: Record, directory: Path) -> tuple[Path, ...]:
    """Write ``fits.h5``, ``fits.csv`` and ``fits.json`` and return their paths."""
    attributes = {
        "configuration": config.to_json(),
        "versions": ", ".join(f"{name} {number}" for name, number in record.versions.items()),
        "date": record.date,
    }
    dataset = table(rows).assign_attrs(attributes)
    hdf5, text = directory / "fits.h5", directory / "fits.csv"
    storage.write(dataset, hdf5)
    with atomic_write(text) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        columns = ["curve", *dataset.data_vars]
        heads = [header(str(name), dataset[name]) for name in columns]
        writer.writerow([*heads, *attributes])
        for row in zip(*(dataset[name].values.tolist() for name in columns), strict=True):
            writer.writerow([*row, *attributes.values()])
    content = {"curves": rows, "configuration": config.to_dict(), **record.to_dict()}
    return hdf5, text, write_json(content, directory / "fits.json")
