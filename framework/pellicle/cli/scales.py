"""Warn of values that are out of scale with the others of a run or of a study."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .printing import print_warning

if TYPE_CHECKING:
    from pellicle.config.run import Run
    from pellicle.config.study import Study


def warn_of_scales(configuration: Run | Study) -> None:
    """Print a warning for each field whose unit is likely to be missing, of a study once."""
    from pellicle.config.scales import doubtful_scales
    from pellicle.config.study import Study

    if isinstance(configuration, Study):
        runs = [point.run for point in configuration.points]
    else:
        runs = [configuration]
    doubts: dict[str, str] = {}
    for run in runs:
        for path, message in doubtful_scales(run):
            doubts.setdefault(path, message)
    for message in doubts.values():
        print_warning(message)
