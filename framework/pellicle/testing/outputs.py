"""What every output keeps: the files it names, and no others, whether or not a run finishes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from pellicle.components import Output, Place
from pellicle.components.calls import files_of
from pellicle.config.output_conflicts import matches
from pellicle.config.run import Run
from pellicle.errors import StorageError
from pellicle.results.result import Result
from pellicle.runs.progress import Progress
from pellicle.runs.runner import execute, solve

from .component import check
from .rules import Rule, require

if TYPE_CHECKING:
    import xarray as xr

_STEPS = 2


def check_output(output: Output) -> None:
    """Check that an output keeps its contract.

    Beside what all components keep: it leaves exactly the files that it names, and that `endings`
    tells, also where the run was cut short and is repeated; each step leaves a trace in them,
    unless a `study` of its own chooses what is shown; a folder that cannot be written is known
    before anything is computed; and it works in a run.

    Raises
    ------
    AssertionError
        It does not; says what was asked and what was found.
    """
    check(output, "output", RULES)


@cache
def _run() -> Run:
    configuration: dict[str, Any] = {
        "title": "Two steps",
        "grid": {"points": [16, 12], "size": ["0.4 mm", "0.3 mm"]},
        "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "1 N/m"},
        "indenter": {"type": "paraboloid", "radius": "1 mm"},
        "loading": {"depth": ["5 um", "10 um"]},
        "corrections": [{"type": "yastrebov"}],
    }
    return Run(**configuration)


@cache
def _dataset() -> xr.Dataset:
    return solve(_run()).dataset


@contextmanager
def _place() -> Iterator[Place]:
    """Yield a place in a folder that does not exist yet."""
    with TemporaryDirectory() as folder:
        yield Place(Path(folder) / "new" / "folder", "indent", _run().to_json(), _run().identity)


def _leave(output: Output, place: Place, steps: xr.Dataset) -> tuple[Path, ...]:
    """Hand steps to the output as a run does; return the files that it names."""
    output.open(place)
    for index in range(steps.sizes["step"]):
        output.step(place, steps.isel(step=slice(index, index + 1)))
    return output.close(place, Result(steps))


def _left(place: Place) -> dict[str, bytes]:
    """Return the content of each file that is there."""
    there = place.directory.rglob("*") if place.directory.exists() else ()
    return {
        path.relative_to(place.directory).as_posix(): path.read_bytes()
        for path in there
        if path.is_file()
    }


def leaves_its_data_as_they_are(output: Output) -> None:
    """step() and close() change nothing of what they are given: others get it too."""
    data = _dataset().copy(deep=True)
    with _place() as place:
        _leave(output, place, data)
    require(data.identical(_dataset()), "the data of the run differ afterwards")


def leaves_the_files_it_names(output: Output) -> None:
    """Cut short, and repeated with all steps, a run leaves what is named and endings() tells."""
    with _place() as place:
        for steps in range(1, _STEPS + 1):
            done = _dataset().isel(step=slice(steps))
            named = files_of(output, "close()", partial(_leave, place=place, steps=done))
            names = {path.relative_to(place.directory).as_posix() for path in named}
            left = _left(place)
            require(
                bool(names) and left.keys() == names,
                f"after {steps} of {_STEPS} steps close() names {sorted(names)}, and there are "
                f"{sorted(left)}",
            )
            for name, content in left.items():
                require(bool(content), f"{name} is empty")
                require(
                    name.startswith(place.name),
                    f"{name} does not begin with {place.name!r}; use place.file(…)",
                )
                told = output.endings()
                require(
                    any(matches(name.removeprefix(place.name), ending) for ending in told),
                    f"{name} is left, and endings() tells {told}",
                )


def loses_no_step(output: Output) -> None:
    """What is left behind differs if any of the steps does, unless study() chooses."""
    if output.draws_studies:
        return
    whole = _dataset()
    left = _content(output, whole)
    # What holds a date or a random name differs between two equal runs: it says nothing here.
    steady = {name for name, content in _content(output, whole).items() if content == left[name]}
    for lost in range(_STEPS):
        other = whole.where(whole["step"] != lost + 1, whole.isel(step=(lost + 1) % _STEPS))
        other = other.transpose(*whole.dims).astype({n: v.dtype for n, v in whole.items()})
        changed = _content(output, other)
        require(
            not steady or any(changed.get(name) != left[name] for name in steady),
            f"step {lost + 1} of {_STEPS} leaves no trace in {sorted(left)}",
        )


def _content(output: Output, steps: xr.Dataset) -> dict[str, bytes]:
    with _place() as place:
        _leave(output, place, steps)
        return _left(place)


def hopeless_folder_is_known_before_computing(output: Output) -> None:
    """open() raises StorageError where nothing can be written: pellicle.storage.check_writable."""
    with TemporaryDirectory() as folder:
        blocked = Path(folder) / "file"
        blocked.write_text("in the way", encoding="utf-8")
        try:
            output.open(Place(blocked / "folder", "indent", _run().to_json(), _run().identity))
        except StorageError as error:
            require("indent" in str(error), f"a message that names no file: {error}")
        else:
            raise AssertionError("open() raises nothing below a folder that is a file")


def works_in_a_run(output: Output) -> None:
    """A run with this output alone leaves its files."""
    with TemporaryDirectory() as folder:
        run = _run().model_copy(update={"outputs": (output,)})
        place = Place(Path(folder), "indent", run.to_json(), run.identity)
        bar = Progress(_STEPS, enabled=False)
        files = execute(run, place, (output,), bar).files
        require(bool(files) and all(path.is_file() for path in files), f"files {files}")


RULES: list[Rule] = [
    leaves_its_data_as_they_are,
    leaves_the_files_it_names,
    loses_no_step,
    hopeless_folder_is_known_before_computing,
    works_in_a_run,
]
