"""Files: the one HDF5 layout, whole at every moment; those that others changed are refused."""

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.errors import StorageError
from pellicle.results import checksum, netcdf, storage
from tests.command import call
from tests.tables_of_runs import RUN, half_space, relaxing

ATTRIBUTES = {"configuration": '{"a": "τ₀"}', "versions": "pellicle 0", "title": "τ₀"}


def steps(*indices: int) -> xr.Dataset:
    """Return a dataset with fields, numbers, flags and texts of some steps."""
    rng = np.random.default_rng(indices[0])
    count = len(indices)
    status = ["converged", "a longer text: τ₀"]
    return xr.Dataset(
        {
            "pressure": (("step", "x", "y"), rng.random((count, 5, 4)), {"units": "Pa"}),
            "contact": (("step", "x", "y"), rng.random((count, 5, 4)) > 0.5, {"units": "1"}),
            "force": (("step",), rng.random(count), {"units": "N"}),
            "iterations": (("step",), np.array(indices) * 10, {"units": "1"}),
            "converged": (("step",), np.array(indices) % 2 == 0, {"units": "1"}),
            "status": (("step",), np.array([status[i % 2] for i in indices], dtype=object)),
        },
        {"step": list(indices), "x": np.arange(5.0), "y": np.arange(4.0)},
        ATTRIBUTES,
    )


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Return the name of a file in a folder that does not exist yet."""
    return tmp_path / "folder" / "result.h5"


def test_append_equals_writing_at_once(path: Path) -> None:
    """Steps written one by one make the file of all steps."""
    storage.write(steps(0), path)
    storage.append(steps(1), path)
    storage.append(steps(2, 3), path)
    joined = xr.concat([steps(0), steps(1), steps(2, 3)], "step", data_vars="all")
    xr.testing.assert_identical(storage.read(path), joined)


def test_readable_by_others(path: Path) -> None:
    """The file opens with h5py and with xarray's own NetCDF reader."""
    storage.write(steps(0, 1), path)
    storage.append(steps(2), path)
    storage.close(path)
    with h5py.File(path) as file:
        assert file["pressure"].shape == (3, 5, 4)
        assert file["pressure"].attrs["units"] == "Pa"
        assert file.attrs["schema_version"] == storage.SCHEMA_VERSION
        assert file["status"].asstr()[1] == "a longer text: τ₀"
    with xr.open_dataset(path, engine="h5netcdf") as opened:
        assert dict(opened.sizes) == {"step": 3, "x": 5, "y": 4}


def test_failed_write_leaves_the_file_whole(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A failure while replacing a file, even an interruption, leaves the old one."""
    storage.write(steps(0, 1), path)
    before = path.read_bytes()

    def interrupt(*arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("os.fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        storage.write(steps(7), path)
    assert path.read_bytes() == before
    assert list(path.parent.iterdir()) == [path]


def test_nothing_half_written_has_the_name(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A new file gets its name only when it is whole and on the disk."""
    seen: list[bool] = []
    monkeypatch.setattr("os.fsync", lambda descriptor: seen.append(path.exists()))
    storage.write(steps(0), path)
    assert seen == [False]
    assert path.exists()


def test_other_schema_version(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file of another schema version is refused with both versions and what wrote it."""
    monkeypatch.setattr(storage, "SCHEMA_VERSION", 99)
    storage.write(steps(0), path)
    monkeypatch.undo()
    with pytest.raises(
        StorageError,
        match=r"version 99, and this pellicle reads 3; read it with what wrote it .pellicle 0",
    ):
        storage.read(path)


@pytest.mark.slow
def test_segments(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a large result each step is written about twice, and every one is there after each."""
    monkeypatch.setattr(storage, "_SMALL", 0)
    joins: list[int] = []
    plain = storage._join

    def join(path: Path, *more: Any) -> Any:
        joins.append(len(more[0]))
        return plain(path, *more)

    monkeypatch.setattr(storage, "_join", join)
    storage.write(steps(0), path)
    for index in range(1, 20):
        storage.append(steps(index), path)
        assert storage.read(path)["step"].values.tolist() == list(range(index + 1))
        assert storage.read(path, without=["x", "y"]).sizes == {"step": index + 1}
    assert joins == [0, 1, 3, 7]
    whole = xr.concat([steps(index) for index in range(20)], "step", data_vars="all")
    xr.testing.assert_identical(storage.read(path), whole)
    storage.close(path)
    assert list(path.parent.iterdir()) == [path]
    xr.testing.assert_identical(storage.read(path), whole)


def test_segments_that_were_joined_already(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A process that dies before it removes what it joined leaves no step twice."""
    monkeypatch.setattr(storage, "_SMALL", 0)
    storage.write(steps(0, 1, 2), path)
    storage.append(steps(3), path)
    (segment,) = (other for other in path.parent.iterdir() if other != path)
    content = segment.read_bytes()
    storage.close(path)
    segment.write_bytes(content)
    assert storage.read(path)["step"].values.tolist() == [0, 1, 2, 3]
    storage.append(steps(4), path)
    assert storage.read(path)["step"].values.tolist() == [0, 1, 2, 3, 4]
    storage.write(steps(0), path)
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("offset", [0, 2])
def test_only_the_next_step_is_appended(path: Path, offset: int) -> None:
    """A step that is there already, or that leaves one out, is refused, and the file stays."""
    storage.write(steps(1, 2), path)
    before = path.read_bytes()
    with pytest.raises(StorageError, match=r"step \d does not continue it: it ends at step 2"):
        storage.append(steps(2 + offset), path)
    # Nor is one of another configuration under the identity of the first.
    with pytest.raises(StorageError, match="step 3 does not continue it"):
        storage.append(steps(3).assign_attrs(identity="another"), path)
    assert path.read_bytes() == before


def test_lack_of_memory_is_reported(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file whose content does not fit in memory is refused in words."""
    storage.write(steps(1), path)

    def exhaust(*arguments: object, **options: object) -> None:
        raise MemoryError

    monkeypatch.setattr(netcdf, "dataset", exhaust)
    with pytest.raises(StorageError, match="does not fit in memory"):
        storage.read(path)


def test_segments_that_are_joined_while_they_are_read(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A result is read whole while the run that writes it goes on."""
    monkeypatch.setattr(storage, "_SMALL", 0)
    storage.write(steps(1, 2, 3), path)
    storage.append(steps(4), path)
    assert len(list(path.parent.iterdir())) == 2
    plain, calls = storage.open_file, []

    def join_first(part: Path, *arguments: Any) -> object:
        calls.append(part)
        # The first two calls count the steps of both files, the third reads the first file.
        if len(calls) == 4:
            assert part != path
            storage.close(path)
        return plain(part, *arguments)

    monkeypatch.setattr(storage, "open_file", join_first)
    assert storage.read(path)["step"].values.tolist() == [1, 2, 3, 4]
    assert list(path.parent.iterdir()) == [path]


def sample() -> xr.Dataset:
    """Return a dataset of every kind of variable and dimension."""
    random = np.random.default_rng(2)
    return xr.Dataset(
        {
            "field": (("step", "x", "y"), random.normal(size=(2, 3, 4)), {"units": "Pa"}),
            "inside": (("step", "x", "y"), random.uniform(size=(2, 3, 4)) < 0.5),
            "missing": ("step", [np.nan, 1.0], {"long_name": "a name"}),
            "count": ("step", [3, 4]),
            "status": ("step", ["converged", "größer"]),
            "lone": ((), 2.5),
            "unnamed": ("other", [1.0, 2.0]),
        },
        {
            "step": [0, 1],
            "x": [0.0, 1.0, 2.0],
            "y": [0.0, 1.0, 2.0, 3.0],
            "zipped": ("step", ["a", "b"]),
        },
        {"title": "Größe", "number": 3},
    )


def test_read_as_it_was(tmp_path: Path) -> None:
    """Values, kinds, names, units, coordinates and their order come back; steps can grow."""
    path = tmp_path / "sample.h5"
    packed = netcdf.serialise(sample(), grows=["step"], packed=["field", "inside"])
    path.write_bytes(packed.getvalue())
    with h5py.File(path) as file:
        assert file["field"].maxshape == (None, 3, 4)
        assert file["missing"].maxshape == (None,)
        assert file["x"].maxshape == (3,)
        assert file["field"].compression == file["inside"].compression == "gzip"
        assert file["count"].compression is None
        assert np.isnan(file["missing"].fillvalue)
        xr.testing.assert_identical(netcdf.dataset(file), sample())
        xr.testing.assert_identical(netcdf.dataset(file, without=["x"]), sample().drop_dims("x"))
    dataset = xr.load_dataset(path, engine="h5netcdf")
    xr.testing.assert_identical(dataset, sample())
    assert list(dataset.data_vars) == list(sample().data_vars)
    assert {name: variable.dtype.kind for name, variable in dataset.items()} == {
        name: variable.dtype.kind for name, variable in sample().items()
    }


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
    """Whatever stands where the checksum should, and if it ends early, the file is refused."""
    path = tmp_path / "r.h5"
    for share in (0.1, 0.5, 0.99, 0.9999):
        path.write_bytes(content[: int(share * len(content))])
        with pytest.raises(pl.StorageError, match=r"r\.h5: "):
            pl.load(path)
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
