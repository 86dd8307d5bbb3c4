"""A result file that was changed is refused before HDF5 parses it."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.results import checksum, storage
from tests.small_run import RUN


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
