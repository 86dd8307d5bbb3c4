"""A checksum after the content of an HDF5 file, verified before HDF5 parses the file.

A changed byte makes HDF5 read another number, allocate an impossible size or end the process. Other
readers ignore bytes after the end of the HDF5 content. The checksum covers all bytes except the
compressed chunks, which zlib checks when it reads them (Adler-32), so that the numbers of a large
file are verified without reading its fields.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

from pellicle.errors import StorageError

_MARK = b"pellicle"
_LENGTH = 16
_BLOCK = 1 << 20


def seal(file: io.BytesIO) -> None:
    """Append the checksum to a complete HDF5 file in memory."""
    import h5py

    skipped: list[tuple[int, int]] = []

    def skip(chunk: h5py.h5d.StoreInfo) -> None:
        # A chunk that compression would not shrink is stored uncompressed, without Adler-32.
        if chunk.filter_mask == 0:
            skipped.append((chunk.byte_offset, chunk.size))

    with h5py.File(file, "r") as content:
        for stored in content.values():
            if stored.compression == "gzip":
                stored.id.chunk_iter(skip)
    skipped.sort()
    end = file.seek(0, io.SEEK_END)
    record = {"sha256": _digest(file, end, skipped), "end": end, "skipped": skipped}
    text = json.dumps(record).encode("ascii")
    file.seek(end)
    file.write(text + b"%0*x" % (_LENGTH, len(text)) + _MARK)


def verify(path: Path) -> bool:
    """Return whether a file has a checksum; a file that does not match it is refused."""
    with path.open("rb") as file:
        size = file.seek(0, io.SEEK_END)
        file.seek(max(0, size - _LENGTH - len(_MARK)))
        length, mark = file.read(_LENGTH), file.read()
        if mark != _MARK:
            return False
        try:
            file.seek(size - _LENGTH - len(_MARK) - int(length, 16))
            end = file.tell()
            record = json.loads(file.read(int(length, 16)))
            intact = record["end"] == end and record["sha256"] == _digest(
                file, end, record["skipped"]
            )
        except (ValueError, LookupError, TypeError, OverflowError):
            intact = False
    if not intact:
        raise StorageError(
            f"{path}: damaged, its content does not match its checksum; restore it from a copy, or "
            "run it again"
        )
    return True


def _digest(file: BinaryIO, end: int, skipped: Sequence[tuple[int, int]]) -> str:
    """Return the SHA-256 of the bytes before ``end`` without some, given by offset and size."""
    digest = hashlib.sha256(json.dumps(skipped).encode("ascii"))
    begin = 0
    for offset, size in (*skipped, (end, 0)):
        file.seek(begin)
        while block := file.read(min(_BLOCK, max(0, offset - begin))):
            digest.update(block)
            begin += len(block)
        begin = offset + size
    return digest.hexdigest()
