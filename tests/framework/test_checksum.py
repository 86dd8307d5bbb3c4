"""Files that others changed, or wrote under a right checksum, are refused in words."""

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.results import checksum, storage
from tests.command import call
from tests.tables_of_runs import RUN, half_space, relaxing


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Return the bytes of a result file of three steps, which were written one by one."""
    path = tmp_path_factory.mktemp("content") / "r.h5"
    steps = pl.run(RUN, progress=False, threads=1).dataset
    storage.write(steps.isel(step=[0]), path)
    for index in (1, 2):
        storage.append(steps.isel(step=[index]), path)
    return path.read_bytes()


def test_a_changed_byte_is_never_another_number(content: bytes, tmp_path: Path) -> None:
    """With any bit of the file changed it is refused, or all that it holds is as it was."""
    path = tmp_path / "r.h5"
    path.write_bytes(content)
    whole = pl.load(path).dataset
    chance = np.random.default_rng(7)
    # The end is the checksum itself; the rest is sampled.
    places = [
        *chance.choice(len(content), 120, replace=False),
        *range(len(content) - 30, len(content)),
    ]
    refused = 0
    for place in map(int, places):
        changed = bytearray(content)
        changed[place] ^= 1 << int(chance.integers(8))
        path.write_bytes(changed)
        try:
            again = pl.load(path).dataset
        except pl.StorageError:
            refused += 1
        else:
            xr.testing.assert_identical(again, whole)
    # Unless the fields are a large part of a file, hardly a byte is not told.
    assert refused > 0.9 * len(places)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.99, 0.9999])
def test_a_truncated_file_is_refused(share: float, content: bytes, tmp_path: Path) -> None:
    """A copy that ended early is not read."""
    path = tmp_path / "r.h5"
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(pl.StorageError, match=r"r\.h5: "):
        pl.load(path)


def test_a_file_that_others_changed_is_refused(content: bytes, tmp_path: Path) -> None:
    """What h5py writes into a result takes its checksum away, and the message says so."""
    path = tmp_path / "r.h5"
    path.write_bytes(content)
    with h5py.File(path, "r+") as file:
        file["force"][0] *= 2
        file.attrs["note"] = "a longer text than there was room for" * 100
    with pytest.raises(
        pl.StorageError, match=r"its checksum is missing|does not match its checksum"
    ):
        pl.load(path)


def test_fields_are_verified_as_they_are_read(content: bytes, tmp_path: Path) -> None:
    """The checksum leaves compressed chunks out, whose own check is met when they are read."""
    path = tmp_path / "r.h5"
    path.write_bytes(content)
    with h5py.File(path) as file:
        chunk = file["pressure"].id.get_chunk_info(1)
    changed = bytearray(content)
    changed[chunk.byte_offset + chunk.size // 2] ^= 16
    path.write_bytes(changed)
    assert checksum.verify(path)
    assert storage.read(path, without=["x", "y"]).sizes["step"] == 3
    with pytest.raises(pl.StorageError, match="not a readable result file"):
        pl.load(path)


@pytest.mark.parametrize(
    "record",
    [
        b"",
        b"[]",
        b"{}",
        b'{"sha256": "", "end": -1, "skipped": []}',
        b'{"sha256": "", "end": 1e9, "skipped": [[0, -5]]}',
        b'{"sha256": "", "end": 0, "skipped": [["a", 3]]}',
        b"\xff\xfe",
    ],
)
def test_strange_records_are_refused(record: bytes, content: bytes, tmp_path: Path) -> None:
    """Whatever stands where the checksum should, the file is refused in words."""
    path = tmp_path / "r.h5"
    path.write_bytes(content + record + b"%016x" % len(record) + b"pellicle")
    with pytest.raises(pl.StorageError, match="does not match its checksum"):
        pl.load(path)


TEXT: Any = np.array("x", dtype=object)
STUDY = RUN | {"study": {"vary": {"kernel.tension": [0.1, 0.2]}}}


def put(name: str, value: Any) -> Any:
    """Return a forgery that fills a variable with a value."""

    def forged(data: xr.Dataset) -> xr.Dataset:
        filled = xr.Variable(data[name].dims, np.full(data[name].shape, value))
        if name in data.coords:
            return data.assign_coords({name: filled})
        return data.assign({name: filled})

    return forged


def attribute(name: str, value: Any) -> Any:
    """Return a forgery that says something else in an attribute; None leaves it out."""

    def forged(data: xr.Dataset) -> xr.Dataset:
        rest = {key: old for key, old in data.attrs.items() if key != name}
        return data.drop_attrs(deep=False).assign_attrs(
            rest if value is None else rest | {name: value}
        )

    return forged


def configured(**changed: Any) -> Any:
    """Return a forgery with another configuration."""

    def forged(data: xr.Dataset) -> xr.Dataset:
        own = json.loads(data.attrs["configuration"]) | changed
        return data.assign_attrs(configuration=json.dumps(own))

    return forged


BOTH = {
    "configuration no JSON": attribute("configuration", "{"),
    "configuration deep": attribute("configuration", "[" * 100_000 + "]" * 100_000),
    "configuration a list": attribute("configuration", "[]"),
    "configuration a number": attribute("configuration", 7),
    "no grid": configured(grid=None),
    "steps in words": attribute("planned_steps", "many"),
    "two tolerances": attribute("tolerance", np.array([1.0, 2.0])),
    "no boundary": attribute("boundary", None),
    "force of text": put("force", TEXT),
    "complex depth": put("depth", 1j),
    "converged of numbers": put("converged", 5.0),
    "caveats no JSON": put("caveats", TEXT),
    "caveats of numbers": put("caveats", np.array("[1]", dtype=object)),
    "caveat without values": put("caveats", np.array('[["COARSE", {}]]', dtype=object)),
    "unknown status": put("status_code", TEXT),
    "steps not whole": put("step", np.nan),
    "no steps": lambda data: data.isel(step=slice(0)),
    "one number for all steps": lambda data: data.assign(iterations=3),
}
RESULT = {
    "pressure of text": put("pressure", TEXT),
    "displacement of text": put("displacement", TEXT),
    "contact of numbers": put("contact", 1.0),
    "another grid": configured(grid={"points": 7, "size": 1.0, "boundary": "free"}),
    "fields the other way": lambda data: data.transpose("y", "x", "step"),
    "coordinates of text": put("x", TEXT),
}
TABLE = {
    "axes no JSON": attribute("axes", "{"),
    "derived a number": attribute("derived", "5"),
    "runs of numbers": put("run", 5.0),
    "one run": lambda data: data.assign(run="x"),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a result and the folder of a study."""
    folder = tmp_path_factory.mktemp("forged")
    pl.run(RUN, progress=False, threads=1).save(folder / "r.h5")
    pl.run_study(STUDY, directory=folder / "s", progress=False)
    return folder


@pytest.mark.parametrize(
    ("kind", "forged"),
    [
        *(pytest.param("r.h5", forged, id=name) for name, forged in (BOTH | RESULT).items()),
        *(
            pytest.param("s/study.h5", forged, id=f"study: {name}")
            for name, forged in (BOTH | TABLE).items()
            if "configuration" not in name and name != "no grid"
        ),
    ],
)
def test_a_forgery_is_refused_in_words(
    kind: str, forged: Any, folder: Path, tmp_path: Path
) -> None:
    """No traceback and no figure: exit 2, the name of the file, and what to do."""
    path = tmp_path / Path(kind).name
    data = (storage.table if "study" in kind else storage.read)(folder / kind)
    storage.write(forged(data), path)
    for command in (["show"], ["show", "--json"], ["plot"]):
        done = call(*command, path, code=2)
        assert done.output.startswith(f"error: {path}: ")
        assert "Traceback" not in done.output
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
def test_what_is_written_is_sound(folder: Path) -> None:
    """Genuine files are shown, of a path that sticks and of a solid that relaxes too."""
    sticks = RUN | {
        "kernel": relaxing(half_space(1e4), 0.5, 1.0),
        "interaction": {"type": "linear", "work_of_adhesion": 1e-3, "range": 1e-6},
        "loading": {"depth": [5e-6, 10e-6], "time": [0.0, 1.0], "stiffness": True},
        "corrections": [{"type": "yastrebov"}],
    }
    pl.run(sticks, progress=False, threads=1).save(folder / "sticks.h5")
    for kind in ("r.h5", "s", "sticks.h5"):
        done = call("show", folder / kind)
        assert done.exit_code in (0, 1), done.output
        assert "error: " not in done.output
