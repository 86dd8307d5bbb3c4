"""The standard figures of a result or of a study, before they are drawn."""

from __future__ import annotations

from pathlib import Path

from pellicle.arrays import Dataset
from pellicle.components import Output
from pellicle.components.charts import Shown
from pellicle.components.installed import registry
from pellicle.results.result import Result
from pellicle.results.runs import StoredRuns


def figures(shown: Result | Dataset) -> dict[str, Shown]:
    """Return what the standard output ``figures`` shows of a result or of the table of a study.

    The keys are the suffixes of its files, such as ``force_depth``.
    """
    if isinstance(shown, Result):
        runs = StoredRuns.of_run(shown.dataset)
    else:
        runs = StoredRuns.of_study(shown, Path())
    output = registry().make(Output, {"type": "figures"})
    return {suffix.removeprefix("-"): part for suffix, part in output.charts(runs)}
