"""Fits of many curves, one row each, by an executor."""

from __future__ import annotations

import hashlib
import json
import pickle
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pellicle.components import Component, Executor, HasForceCurve, Indenter, Say
from pellicle.components.calls import outcomes_of
from pellicle.errors import PellicleError
from pellicle.files import check_writable
from pellicle.plugins import registry
from pellicle.runs.progress import StudyProgress

from .curves.curve import Segment
from .curves.sources import Curves, Source, gather
from .fit import fitted
from .models.simulation import GRID_POINTS
from .posed import Posed, posed
from .problem import Baseline
from .table import FAILED, FITTED, NOT_RUN, table, write
from .written import write_json

if TYPE_CHECKING:
    import xarray as xr

_BYTES_A_POINT = 2000
"""Memory of a fit, about."""


@dataclass(frozen=True)
class FitTask:
    """A curve that is to be fitted; it pickles to workers."""

    place: int
    """Its row."""
    posed: Posed
    path: Path | None
    """Where the fit is kept."""

    @property
    def name(self) -> str:
        """What a progress bar calls it."""
        return self.posed.name

    @property
    def memory(self) -> int:
        """Memory that the fit takes at its peak [bytes], estimated."""
        return _BYTES_A_POINT * self.posed.curve.force.size


class Fitted(NamedTuple):
    """What came of many curves."""

    rows: list[dict[str, Any]]
    """What JSON can hold of each curve: its name, ``status``, and what `Fit.to_dict` says."""
    files: tuple[Path, ...]
    taken: int
    """How many fits were done before."""

    @property
    def failed(self) -> int:
        """How many curves could not be fitted."""
        return sum(row["status"].startswith(FAILED) for row in self.rows)


def fit_many(
    curves: Curves,
    *,
    indenter: str | Mapping[str, Any] | Indenter | HasForceCurve,
    kernel: str | Mapping[str, Any] | None = None,
    poissons_ratio: float | None = None,
    fix: Mapping[str, Any] | None = None,
    baseline: Baseline = "none",
    segment: Segment = "approach",
    cache: str | Path | None = None,
    grid_points: int = GRID_POINTS,
    executor: str | Mapping[str, Any] | Executor = "serial",
    directory: str | Path | None = None,
    progress: bool = True,
    **fields: Any,
) -> xr.Dataset:
    """Fit each of many curves on its own and return a table with a row for each.

    A curve that cannot be fitted does not stop the others: its row says why.

    Parameters
    ----------
    curves
        A folder; a file, which may hold several curves; a table that lists files, with a header
        such as ``file,radius [um]``; several of these; or position [m] and force [N] of each curve
        by its name, ``{"first": (position, force)}``.
    indenter, kernel, poissons_ratio, fix, baseline, segment, cache, grid_points
        As for `fit`.
    executor
        How the fits, and the runs of a study that they need, are carried out: ``"serial"``,
        ``"processes"``, ``"dask"``, a table such as ``{"type": "processes", "workers": 2}``, or an
        executor.
    directory
        Folder for the table, as ``fits.h5``, ``fits.csv`` and ``fits.json``, and a file for each
        curve in ``curves``. A fit that it holds already is not done again.
    progress
        Show a bar on a terminal; without one, a line for each curve.
    **fields
        Of the indenter, and spring_constant and sensitivity if the files lack force or deflection;
        a list has a value for each file: ``radius=["5 um", "20 um"]``.

    Returns
    -------
    xarray.Dataset
        Over ``curve``: each parameter as value, ``_low``, ``_high`` (NaN: open) and ``_bound``,
        with noise, χ² and the messages. ``status`` is ``fitted``, or says why there is no fit.

    Raises
    ------
    ConfigError, PluginError
        An argument is not allowed, or there is no curve; nothing was fitted.
    StorageError
        The folder cannot be used.
    """
    sources = gather(curves, segment, fields)
    options = {
        "kernel": kernel,
        "poissons_ratio": poissons_ratio,
        "fix": fix,
        "baseline": baseline,
        "segment": segment,
    }
    done = carry_out(
        sources,
        indenter,
        options,
        executor,
        None if directory is None else Path(directory),
        cache=cache,
        grid_points=grid_points,
        progress=progress,
    )
    return table(done.rows)


def carry_out(
    sources: list[Source],
    indenter: str | Mapping[str, Any] | Indenter | HasForceCurve,
    options: Mapping[str, Any],
    executor: str | Mapping[str, Any] | Executor,
    directory: Path | None,
    *,
    cache: str | Path | None = None,
    grid_points: int = GRID_POINTS,
    progress: bool,
) -> Fitted:
    """Fit each source, but for what is done, and leave the files.

    ``options`` are those of `question`.  What is interrupted leaves the table of all that was
    finished.
    """
    chosen = {"type": executor} if isinstance(executor, str) else executor
    carrier = registry().make(Executor, chosen)
    if directory is not None:
        check_writable(directory / "fits.h5")
    rows: list[dict[str, Any]] = [{"curve": source.name, "status": NOT_RUN} for source in sources]
    study = {
        "cache": cache,
        "executor": carrier,
        "grid_points": grid_points,
        "progress": progress,
    }
    tasks: list[FitTask] = []
    for place, each in enumerate(posed(sources, indenter, options)):
        try:
            if isinstance(each, PellicleError):
                raise each
            path = _file(directory, each, grid_points)
            if (done := _done(path)) is not None:
                rows[place] |= done | {"status": FITTED}
                continue
            tasks.append(FitTask(place, each.modelled(**study), path))
        except PellicleError as error:
            rows[place]["status"] = _why(error, sources[place])
    taken = sum(row["status"] == FITTED for row in rows)
    files: tuple[Path, ...] = ()
    try:
        with (
            StudyProgress(len(sources), len(sources) - len(tasks), progress) as bar,
            closing(outcomes_of(carrier, work, tasks, bar.report, dict)) as ends,
        ):
            for task, outcome in ends:
                if isinstance(outcome, Exception):
                    rows[task.place]["status"] = _why(outcome, sources[task.place])
                else:
                    rows[task.place] |= outcome | {"status": FITTED}
                    if task.path is not None:
                        write_json(outcome, task.path)
                verdict = str(rows[task.place]["status"])
                bar.finished(task, verdict, verdict != FITTED)
    finally:
        if directory is not None:
            files = write(rows, directory)
    return Fitted(rows, files, taken)


def work(task: FitTask, say: Say) -> dict[str, Any]:
    """Fit a curve where a worker is."""
    return fitted(task.posed).to_dict()


def _file(directory: Path | None, posed: Posed, grid_points: int) -> Path | None:
    """Return where a fit is kept."""
    if directory is None:
        return None
    return directory / "curves" / f"{_identity(posed, grid_points)[:16]}.json"


def _identity(posed: Posed, grid_points: int) -> str:
    """Return what tells this curve and what is asked of it from all others."""
    curve, asked = posed.curve, posed.asked
    known = hashlib.sha256(version("pellicle").encode())
    kernel = asked.material and asked.material.kernel
    for part in (asked.indenter, kernel):
        if isinstance(part, Component):
            known.update(part.model_dump_json().encode())
        else:
            known.update(pickle.dumps(part))
    fixed = {parameter.name: value for parameter, value in asked.fixed.items()}
    said = fixed, asked.segment, asked.poissons_ratio, grid_points if kernel else None
    known.update(repr((said, curve.messages, curve.stiffness)).encode())
    for values in (curve.position, curve.force):
        known.update(values.tobytes())
    return known.hexdigest()


def _done(path: Path | None) -> dict[str, Any] | None:
    """Return the fit that a file holds."""
    if path is None:
        return None
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def _why(error: Exception, source: Source) -> str:
    """Return a failure as a line of a table."""
    ours = isinstance(error, PellicleError)
    said = "; ".join(source.reason(error).splitlines()) or "no reason given"
    return f"{FAILED}{said if ours else f'{type(error).__name__}: {said}'}"
