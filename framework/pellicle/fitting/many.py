"""Fits of many curves, one row each, by an executor."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from pellicle.components import Executor, Indenter, Say
from pellicle.errors import ConfigError, PellicleError
from pellicle.plugins import registry
from pellicle.progress import StudyProgress
from pellicle.storage import check_writable

from .curve import Segment
from .fit import Baseline, Fit, fit, question
from .measured import Measured
from .rows import FAILED, FITTED, NOT_RUN, table, write
from .sources import Curves, Source, gather
from .written import write_json

if TYPE_CHECKING:
    from collections.abc import Generator

    import xarray as xr

_BYTES_A_POINT = 2000
"""Memory of a fit, about."""


@dataclass(frozen=True)
class FitTask:
    """A curve that is to be fitted; it pickles to workers."""

    name: str
    place: int
    """Its row."""
    measured: Measured = field(repr=False)
    options: Mapping[str, Any]
    """Of `fit`; the indenter is made."""

    @property
    def memory(self) -> int:
        """Memory that the fit takes at its peak [bytes], estimated."""
        return _BYTES_A_POINT * np.size(self.measured.force)

    @property
    def identity(self) -> str:
        """What tells this curve and what is asked of it from all others."""
        from pellicle import __version__

        options = {**self.options, "indenter": repr(self.options["indenter"])}
        said = json.dumps([__version__, options], sort_keys=True, default=str)
        known = hashlib.sha256(said.encode())
        for values in (self.measured.position, self.measured.depth, self.measured.force):
            known.update(b"-" if values is None else np.asarray(values, dtype=float).tobytes())
        return known.hexdigest()


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
    indenter: str | Mapping[str, Any] | Indenter,
    poissons_ratio: float | None = None,
    fix: Mapping[str, Any] | None = None,
    baseline: Baseline = "none",
    segment: Segment = "approach",
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
    indenter, poissons_ratio, fix, baseline, segment
        As for `fit`.
    executor
        How the fits are carried out: ``"serial"``, ``"processes"``, ``"dask"``, a table such as
        ``{"type": "processes", "workers": 2}``, or an executor.
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
    options = {
        "poissons_ratio": poissons_ratio,
        "fix": fix,
        "baseline": baseline,
        "segment": segment,
    }
    folder = None if directory is None else Path(directory)
    sources = gather(curves, segment, fields)
    return table(carry_out(sources, indenter, options, executor, folder, progress=progress).rows)


def carry_out(
    sources: list[Source],
    indenter: str | Mapping[str, Any] | Indenter,
    options: Mapping[str, Any],
    executor: str | Mapping[str, Any] | Executor,
    directory: Path | None,
    *,
    progress: bool,
) -> Fitted:
    """Fit each source, but for what is done, and leave the files.

    What is interrupted leaves the table of all that was finished.
    """
    chosen = {"type": executor} if isinstance(executor, str) else executor
    carrier = registry().make(Executor, chosen)
    if directory is not None:
        check_writable(directory / "fits.h5")
    rows: list[dict[str, Any]] = [{"curve": source.name, "status": NOT_RUN} for source in sources]
    tasks, taken = [], 0
    for place, source in enumerate(sources):
        made = _task(place, source, indenter, options)
        if isinstance(made, PellicleError):
            rows[place]["status"] = _why(made).replace(f"{source.name}: ", "", 1)
        elif (done := _done(made, directory)) is not None:
            rows[place] |= done | {"status": FITTED}
            taken += 1
        else:
            tasks.append(made)
    files: tuple[Path, ...] = ()
    try:
        with (
            StudyProgress(len(sources), len(sources) - len(tasks), progress, "curves") as bar,
            closing(cast("Generator[Any]", carrier.map(work, tasks, bar.report))) as ends,
        ):
            for task, outcome in ends:
                if isinstance(outcome, Exception):
                    rows[task.place]["status"] = _why(outcome)
                else:
                    rows[task.place] |= outcome | {"status": FITTED}
                    if directory is not None:
                        write_json(outcome, _file(task, directory))
                verdict = str(rows[task.place]["status"])
                bar.finished(task, verdict, verdict != FITTED)
    finally:
        if directory is not None:
            files = write(rows, directory)
    return Fitted(rows, files, taken)


def work(task: FitTask, say: Say) -> dict[str, Any]:
    """Fit a curve where a worker is."""
    return fit_measured(task.measured, **task.options).to_dict()


def fit_measured(measured: Measured, **options: Any) -> Fit:
    """Return the fit of a curve as a reader gave it."""
    made = fit(measured.position, measured.force, depth=measured.depth, **options)
    return replace(made, messages=(*measured.messages, *made.messages))


def _task(
    place: int,
    source: Source,
    indenter: str | Mapping[str, Any] | Indenter,
    options: Mapping[str, Any],
) -> FitTask | PellicleError:
    """Return the task of a source, or why there is none; raise if it is no fault of the curve."""
    if isinstance(source.curve, PellicleError):
        return source.curve
    is_depth = source.curve.depth is not None
    try:
        asked = question(indenter, source.fields, is_depth=is_depth, **options)
    except ConfigError as error:
        raise ConfigError(f"{source.name}: {error}") from None
    return FitTask(source.name, place, source.curve, {**options, "indenter": asked.indenter})


def _file(task: FitTask, directory: Path) -> Path:
    return directory / "curves" / f"{task.identity[:16]}.json"


def _done(task: FitTask, directory: Path | None) -> dict[str, Any] | None:
    """Return the fit that a folder holds of a task."""
    if directory is None:
        return None
    try:
        found = json.loads(_file(task, directory).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def _why(error: object) -> str:
    """Return a failure as a line of a table."""
    said = "; ".join(str(error).splitlines()) or "no reason given"
    ours = isinstance(error, PellicleError)
    return f"{FAILED}{said if ours else f'{type(error).__name__}: {said}'}"
