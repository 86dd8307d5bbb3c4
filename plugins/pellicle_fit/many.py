"""Fits of many curves by an executor, and the files that they leave."""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Iterable, Sequence
from contextlib import nullcontext, suppress
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from itertools import islice
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pandas as pd

from pellicle import registry, results
from pellicle.batch import BatchProgress, LockedError, Part, lock_files, run_tasks
from pellicle.components import Component, Executor, HasForceCurve, Indenter, Say
from pellicle.errors import ConfigError, PellicleError, StorageError
from pellicle.files import atomic_write, check_writable, is_file

from .config import FitConfig
from .config_input import describe_indenter
from .estimation.coordinates import MODULUS
from .files.measurement import Measurement
from .files.sources import Source
from .part import FITTED_ELSEWHERE, FitTask, passes
from .population.fits import ManyFits, summary, table
from .population.images import force_maps
from .population.judgement import Names, group_of, judge
from .population.row import Row, as_json, sketch
from .problem import components_of, problem, record_of
from .report.paper_table import save_tables
from .report.population import save_population
from .representatives import beside, representatives
from .result import data_of
from .sealed_json import read_sealed, write_sealed
from .selection.calibration import common_errors
from .words.story import shares

_JOURNAL = "curves"
_WITHOUT_EFFECT = {
    *("curves", "indenter", "per_file", "pool", "executor", "cache"),
    *("accept", "rejected", "group_by"),
}
"""Fields of a configuration that do not change the fit of a curve."""
_OF_FILES = {"curves", "per_file"}
"""Fields of a configuration that have an entry for each file."""
_OF_ALL = {"configuration", "versions", "date", "wall_time"}
"""What the JSON of a population has once."""
_BYTES_PER_POINT = 2000
"""Memory of a fit, approximately."""
_BATCH = 500
"""Curves that are in memory at once."""
_PAGES = 20
"""Most pages of the contact sheet, a curve of which takes 0.04 s."""


def fit_sources(
    config: FitConfig,
    sources: Iterable[Source],
    directory: str | Path | None,
    *,
    progress: bool,
    formats: Sequence[str] = ("png",),
    part: Part | None = None,
    wait: bool = False,
) -> ManyFits:
    """Fit each curve that is not fitted yet, and write the files.

    Curves are read in batches, so that a population does not have to fit in memory. Of a part
    the fits alone are kept, and returned. One process at a time writes the files, for which others
    ``wait`` or are refused.
    """
    directory = None if directory is None else Path(directory)
    rejected = None if config.rejected is None else Names(config.rejected)
    fits, began = ManyFits([], configuration=config.to_dict()), perf_counter()
    tried, keep = list[tuple[Row, Path | None]](), partial(_keep, writes=part is None)
    with nullcontext() if directory is None or part else lock_files(directory, "fits", wait=wait):
        if directory is not None:
            if part is None:
                check_writable(directory / "fits.h5")
            check_writable(directory / _JOURNAL / "fit.json")
        with BatchProgress(0, 0, progress, "curves") as bar:
            curves = iter(sources)
            while batch := [*islice(curves, _BATCH)]:
                made = [_task(config, source, directory, fits, progress) for source in batch]
                bar.expect(max(len(fits.rows), *(s.total for s in batch)), made.count(None))
                rows = fits.rows[-len(batch) :]
                near = (
                    [()] * len(batch)
                    if config.every_rival
                    else representatives(config, batch, rows)
                )
                for chosen, fit_one in passes(made, near, rows, part, work):
                    like = {i: beside(rows, near[i]) for i in chosen}
                    tasks = [
                        replace(t, like=like[i]) for i, t in enumerate(made) if t and i in like
                    ]
                    run_tasks(config.executor, fit_one, tasks, dict, keep, bar)
                tried += [(task.row, task.path) for task in made if task]
                for row in rows:
                    row.pack()
        if part is not None:
            left = sum(row.is_open and not (path and is_file(path)) for row, path in tried)
            return replace(fits, rows=[row for row, _ in tried if not row.is_open], left=left)
        notes = judge(fits.rows, config.accept, rejected)
        fits.maps, of_maps = force_maps(fits.rows)
        fits.notes += [*notes, *of_maps]
        if directory is not None:
            tables = _write(fits, config, began, directory)
            fits.files = (*tables, *save_population(fits, directory, formats, _PAGES))
    return fits


def _task(
    config: FitConfig, source: Source, directory: Path | None, fits: ManyFits, progress: bool
) -> FitTask | None:
    """Add a row for a curve, and return the fit of it if there is none yet."""
    column = str(source.fields.get(config.group_by.lower(), ""))
    row = Row(source.name, group_of(config.group_by, source.file, column))
    fits.rows.append(row)
    try:
        indenter = config.indenter_of(source)
    except ConfigError as error:
        raise source.with_name(error) from None
    curve = source.curve
    try:
        if isinstance(curve, PellicleError):
            raise curve
        row.map, row.site = source.map, curve.site
        with suppress(TypeError, ValueError):
            row.sketch = sketch(position=curve.position, force=curve.force)
        path, fields = None, source.fields.keys()
        own = {*fields, *(["radius"] if "diameter" in fields else [])}
        common = {name: x for name, x in config.uncertainty.items() if name not in own}
        if directory is not None:
            identity = _identity(config, indenter, curve, [*common])
            path = directory / _JOURNAL / f"{identity[:16]}.json"
            row.kept = f"{_JOURNAL}/{path.name}"
            if is_file(path) and (earlier := _earlier(path, row, fits)):
                # The file may have another name now.
                earlier["curves"][0] |= {"name": source.name, "data": data_of(curve, config)}
                row.keep(earlier)
                fits.resumed += 1
                return None
        weighed = {n: x for n, x in config.uncertainty.items() if n not in common}
        config = config.model_copy(update={"uncertainty": weighed})
        ready = problem(config, [source], progress=progress)
    except PellicleError as error:
        row.failure = _in_a_line(source.reason(error))
        return None
    # An executor need not pickle.
    serial = registry().make(Executor, {"type": "serial"})
    ready = replace(ready, config=config.model_copy(update={"executor": serial}))
    memory = _BYTES_PER_POINT * ready.curves[0].force.size
    return FitTask(row.name, memory, row, ready, path, common)


def _earlier(path: Path, row: Row, fits: ManyFits) -> dict[str, Any] | None:
    """Return the fit of a row that was kept; of a file that is not that there is a note."""
    try:
        return read_sealed(path)
    except StorageError:
        fits.notes.append(f"{path} is not the fit that pellicle kept: {row.name} is fitted again")
        return None


def _keep(task: FitTask, outcome: dict[str, Any] | Exception, *, writes: bool) -> tuple[str, bool]:
    """Keep what came of a fit in its row and its file; return the status, and whether it failed."""
    row = task.row
    if isinstance(outcome, LockedError):
        return FITTED_ELSEWHERE, False
    if isinstance(outcome, Exception):
        kind = "" if isinstance(outcome, PellicleError) else f"{type(outcome).__name__}: "
        row.failure = f"{kind}{_in_a_line(str(outcome))}"
    else:
        if writes and task.path is not None:
            write_sealed(outcome, task.path)
        row.keep(outcome)
    return row.status, not row.is_fitted


def work(task: FitTask, say: Say) -> dict[str, Any]:
    """Fit a curve in a worker, and return JSON data of the fit, with what a population adds."""
    fit = task.problem.fit(like=task.like)
    selected, (force,) = fit.answer.selected, fit.forces()
    (curve,) = selected.all_rows
    load = force - selected.known[0].free_force(curve)
    measured, position = curve.force, curve.position
    scatter = measured - np.mean(measured)
    drawn = sketch(position=position, force=measured, fit=force)
    data = {name: value for name, value in fit.data.items() if name not in _OF_ALL}
    if task.common:
        own = [data["calibration"]] if fit.config.uncertainty else []
        beside = f"common error, beside the medians alone: {shares(task.common)}"
        data["calibration"] = "; ".join([*own, beside])
        moved = data["common_errors"] = common_errors(selected, task.common)
        if MODULUS in moved and (ratio := data["poissons_ratio"]) is not None:
            of_youngs = {name: (1 - ratio**2) * error for name, error in moved[MODULUS].items()}
            moved["youngs_modulus"] = of_youngs
    return data | {
        "r_squared": 1 - float(np.sum((force - measured) ** 2) / np.sum(scatter**2)),
        "indentation": float(np.max(selected.depths[0])),
        "largest_force": float(np.max(load)),
        "sketch": as_json(drawn),
    }


def _identity(
    config: FitConfig, indenter: Indenter | HasForceCurve, curve: Measurement, common: Sequence[str]
) -> str:
    """Return a hash that is equal for fits with equal results."""
    options = config.model_dump(mode="json", exclude=_WITHOUT_EFFECT, fallback=str)
    of_curve = (
        describe_indenter(indenter),
        curve.is_depth,
        curve.stiffness,
        curve.speed,
        curve.messages,
    )
    plugins = registry().versions(components_of(config) - {type(config.executor)})
    versions = version("pellicle"), sorted(plugins.items())
    digest = hashlib.sha256(repr((versions, options, common, of_curve)).encode())
    if not isinstance(indenter, Component):
        digest.update(pickle.dumps(indenter))
    for values in (curve.position, curve.force, *([] if curve.time is None else [curve.time])):
        digest.update(np.asarray(values).tobytes())
    return digest.hexdigest()


def _in_a_line(reason: str) -> str:
    return "; ".join(reason.replace(":\n  ", ": ").splitlines()) or "no reason given"


def _write(fits: ManyFits, config: FitConfig, began: float, directory: Path) -> tuple[Path, ...]:
    """Write the tables of the curves and of the groups, and return their paths."""
    record = record_of(config, (row.fit.curve["data"] for row in fits.rows if row.is_fitted), began)
    attributes = {
        "configuration": config.to_json(),
        "versions": ", ".join(f"{name} {number}" for name, number in record["versions"].items()),
        "date": record["date"],
    }
    dataset = table(fits.rows).assign_attrs(attributes)
    hdf5, text, groups = (directory / f"fits{end}" for end in (".h5", ".csv", "-groups.csv"))
    results.write(dataset.assign_attrs(command="fit"), hdf5)
    heads = {name: results.header(str(name), of) for name, of in dataset.data_vars.items()}
    # In each row a list of all files would make the table grow as their number squared.
    own = config.model_dump_json(exclude_none=True, exclude=_OF_FILES)
    frame = dataset.to_dataframe().rename(columns=heads)
    frame = frame.assign(**attributes | {"configuration": own})
    lines = summary(fits.rows)
    for path, content in ((text, frame.reset_index()), (groups, pd.DataFrame(lines))):
        with atomic_write(path) as part:
            content.to_csv(part, index=False, na_rep="nan")
    paper = save_tables(fits.rows, directory / "fits-table")
    whole = {"groups": lines, "notes": fits.notes, "configuration": fits.configuration} | record
    # What is drawn again has no other source.
    curves = (row.to_dict() | {"sketch": as_json(row.sketch)} for row in fits.rows)
    return hdf5, text, groups, *paper, write_sealed(whole, directory / "fits.json", curves)
