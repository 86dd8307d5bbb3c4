"""Contract rules of outputs: all files, all steps, in runs and studies."""

from __future__ import annotations

import json
from dataclasses import replace
from fnmatch import fnmatch
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import xarray as xr

from pellicle.checks import read_only_dataset
from pellicle.components import Output
from pellicle.config.file_names import stem_of
from pellicle.config.run import Run
from pellicle.config.study import Study
from pellicle.results.derived import FIRST_RUN
from pellicle.results.runs import StoredRuns
from pellicle.runs.journal import Journal
from pellicle.runs.outputs import files_of
from pellicle.runs.progress import RunProgress
from pellicle.runs.runner import execute, solve
from pellicle.studies import runner as studies

from .component import check, require, rules_of
from .small_runs import PARABOLOID

_STEPS = 2
_VARIED = "kernel.tension"
_RUN: dict[str, Any] = {
    "title": "Two steps",
    "grid": {"points": [16, 12], "size": ["0.4 mm", "0.3 mm"]},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "1 N/m"},
    "indenter": PARABOLOID,
    "loading": {"depth": ["5 um", "10 um"], "stiffness": True},
    "corrections": [{"type": "yastrebov"}],
}


def check_output(output: Output) -> None:
    """Check that an output keeps its contract: the rules below, and those of all components."""
    check(output, Output, rules_of(__name__))


@cache
def _run() -> Run:
    return Run(**_RUN)


@cache
def _dataset() -> xr.Dataset:
    return read_only_dataset(solve(_run()).dataset)


def _write(output: Output, stem: Path, steps: xr.Dataset) -> tuple[Path, ...]:
    """Call the output as a run does, or a study if it shows those alone; return its files."""
    own, configuration = stem_of(output, stem), _run().to_json()
    for index in range(steps.sizes["step"]):
        output.step(steps.isel(step=slice(index, index + 1)), own)
    runs = StoredRuns.of_run(steps.copy(), configuration)
    if output.scope == "study":
        attributes = {"axes": json.dumps({_VARIED: [_VARIED]}), FIRST_RUN: configuration}
        table = runs.table.expand_dims({_VARIED: [1.0]}).assign_attrs(attributes)
        runs = replace(runs, table=table)
    return files_of(output, runs, stem)


def _contents(folder: Path) -> dict[str, bytes]:
    """Return the content of each file in a folder."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def _written(output: Output, steps: xr.Dataset) -> dict[str, bytes]:
    """Return the content of each file that the output writes for some steps."""
    with TemporaryDirectory() as folder:
        stem = Path(folder) / "indent"
        _write(output, stem, steps)
        return _contents(stem.parent)


def leaves_the_files_it_returns(output: Output) -> None:
    """A run, also if interrupted and repeated, has the files of write(), with its `suffixes`."""
    with TemporaryDirectory() as folder:
        stem = Path(folder) / "indent"
        own = stem_of(output, stem).name
        # Interrupted after each step, the run is repeated with the same stem.
        for steps in range(1, _STEPS + 1):
            files = _write(output, stem, _dataset().isel(step=slice(steps)))
            names = {path.relative_to(stem.parent).as_posix() for path in files}
            contents = _contents(stem.parent)
            require(
                contents.keys() == names,
                f"after {steps} of {_STEPS} steps write() returns {sorted(names)}, but the folder "
                f"has {sorted(contents)}",
            )
            for name, content in contents.items():
                require(bool(content), f"{name} is empty")
                require(
                    any(fnmatch(name, f"{own}{suffix}") for suffix in output.suffixes),
                    f"{name} is written, but the suffixes are {output.suffixes}",
                )


def loses_no_step(output: Output) -> None:
    """The files differ if any step does, unless the output can also show a study."""
    if output.scope != "run":
        return
    whole = _dataset()
    contents, again = _written(output, whole), _written(output, whole)
    # A file with a date or a random name differs between two equal runs, and proves nothing.
    steady = {name for name, content in again.items() if content == contents.get(name)}
    if not steady:
        return
    for lost in range(_STEPS):
        # The numbers of another step stand in its place.
        indices = [index if index != lost else (lost + 1) % _STEPS for index in range(_STEPS)]
        changed = _written(output, whole.isel(step=indices).assign_coords(step=whole["step"]))
        require(
            any(changed.get(name) != contents[name] for name in steady),
            f"step {lost + 1} of {_STEPS} leaves no trace in {sorted(contents)}",
        )


def works_in_a_run(output: Output) -> None:
    """A run with this output alone has its files beside the result file."""
    if output.scope == "study":
        return
    with TemporaryDirectory() as folder:
        stem = Path(folder) / "indent"
        run = _run().model_copy(update={"outputs": (output,)})
        journal, bar = Journal(stem, run.identity), RunProgress(_STEPS, False)
        for path in execute(run, journal, (output,), bar).files:
            require(path.is_file(), f"{path} is missing")


def works_in_a_study(output: Output) -> None:
    """A study of two runs with this output has its files."""
    with TemporaryDirectory() as folder:
        run = _run().to_table() | {"outputs": [output]}
        study = Study.from_mapping(run | {"study": {"vary": {_VARIED: [0.1, 0.2]}}})
        result = studies.execute(study, Path(folder))
        statuses = {*result.result["status"].values.ravel()}
        for path in result.files:
            require(path.is_file(), f"{path} is missing")
        require(bool(result.result["converged"].all()), f"the runs end as {statuses}")
