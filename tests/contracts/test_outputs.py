"""What every output keeps: the files it names, and no others, whether or not a run finishes."""

from pathlib import Path
from typing import Any

import pytest

import pellicle as pl
from pellicle import Output, Place, Result, StorageError

RUN: dict[str, Any] = {
    "title": "Two steps",
    "grid": {"points": [16, 12], "size": ["0.4 mm", "0.3 mm"]},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "1 N/m"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": ["5 um", "10 um"]},
    "corrections": [{"type": "yastrebov"}],
}


@pytest.fixture(scope="module")
def result() -> Result:
    """Return a small result of two steps."""
    return pl.run(RUN, progress=False)


def leave(output: Output, place: Place, result: Result, steps: int) -> tuple[Path, ...]:
    """Hand the first steps of a result to the output as a run does; return its files."""
    done = result.dataset.isel(step=slice(0, steps))
    output.open(place)
    for index in range(steps):
        output.step(place, done.isel(step=[index]))
    return output.close(place, Result(done))


@pytest.fixture
def place(tmp_path: Path) -> Place:
    """Return a place in a folder that does not exist yet."""
    run = pl.Run(**RUN)
    return Place(tmp_path / "new" / "folder", "indent", run.to_json(), run.identity)


@pytest.mark.parametrize("steps", [1, 2])
def test_leaves_the_files_it_names(
    output: Output, place: Place, result: Result, steps: int
) -> None:
    """After all steps, or those before an interruption, exactly the named files are there."""
    files = leave(output, place, result, steps)
    assert files
    assert set(place.directory.iterdir()) == set(files)
    assert all(path.stat().st_size > 0 and path.name.startswith("indent") for path in files)


def test_the_same_run_may_be_repeated(output: Output, place: Place, result: Result) -> None:
    """Results of the same configuration are replaced, also those of a run that was cut short."""
    leave(output, place, result, 1)
    assert set(leave(output, place, result, 2)) == set(place.directory.iterdir())


def test_a_folder_that_cannot_be_written_is_known_before_computing(
    output: Output, tmp_path: Path
) -> None:
    """Opening fails with the name of the file and a remedy where nothing can be written."""
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(StorageError, match=r"indent.*cannot be written.*choose another folder"):
        output.open(Place(tmp_path / "file" / "folder", "indent", "{}"))
