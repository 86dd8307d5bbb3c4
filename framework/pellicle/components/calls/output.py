"""Calls of an output: the files that it writes."""

from __future__ import annotations

from pathlib import Path

from pellicle.checks import component_name, errors_attributed_to
from pellicle.components.output import Output, Runs, stem_of
from pellicle.errors import PluginError, shown


def files_of(output: Output, runs: Runs, stem: Path) -> tuple[Path, ...]:
    """Let an output write its files for a run or study with the given stem; return their paths."""
    with errors_attributed_to(output):
        files = output.write(runs, stem_of(output, stem))
    require_files(output, files, stem)
    return tuple(files)


def require_files(output: Output, files: object, stem: Path) -> None:
    """Refuse the value that write() of an output returned unless it lists files of its own stem."""
    own = stem_of(output, stem)
    call = f"{component_name(output)}: write(runs, stem) returned"
    if not isinstance(files, (tuple, list)) or not all(isinstance(path, Path) for path in files):
        raise PluginError(
            f"{call} {shown(files)}; it has to return a tuple of pathlib.Path, empty if there is "
            "none"
        )
    for path in files:
        if not str(path).startswith(str(own)):
            raise PluginError(f"{call} {path}; its files have to begin with the stem, {own}")
