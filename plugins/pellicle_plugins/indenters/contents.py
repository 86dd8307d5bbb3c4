"""Files that hold something else than heights, for a message that says what to do."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Collection
from itertools import islice
from pathlib import Path
from typing import Any

from .file_checks import HDF5, datasets

_SAVE = "save heights with numpy.save and give them as type = 'heights'"
_IMAGES = dict.fromkeys((b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"), "TIFF") | {b"\x89PNG": "PNG"}


def contents(path: Path, metadata: dict[str, Any]) -> str:
    """Return what a file without heights holds, as far as its format or ``metadata`` tell."""
    with path.open("rb") as file:
        head = file.read(8)
    if kind := _IMAGES.get(head[:4]):
        return f"is a {kind} image without a scale of heights; {_SAVE}"
    if head == HDF5:
        with datasets(path) as arrays:
            names = [f"{name!r} of shape {a.shape}, {a.dtype}" for name, a in arrays.items()]
        return f"holds no 2-D array of real numbers, but {first(names)}; {_SAVE}"
    if head.startswith(b"GWYP"):
        names = [
            f"{metadata.get(f'{key}/title', key)!r} in {unit_of_image(metadata, key) or 'no unit'}"
            for key in filter(re.compile(r"/\d+/data").fullmatch, metadata)
        ]
        return f"holds no image of heights, but {first(names)}; give another"
    if zipfile.is_zipfile(path):
        with zipfile.ZipFile(path) as archive:
            index = archive.read("main.xml") if "main.xml" in archive.namelist() else b""
        if revision := re.search(rb"<Revision>(.*?)<", index):
            where = "a binary file" if b"PointDataLink" in index else "text"
            return (
                f"is an X3P of revision {revision[1].decode(errors='replace')!r} with heights in "
                f"{where}, damaged or not of the kind that is read: areal (SUR), revision "
                "'ISO5436 - 2000', heights in a binary file; export it as such"
            )
    return ""


def unit_of_image(metadata: dict[str, Any], key: str) -> str:
    """Return the unit of the values of an image of Gwyddion as it is stated."""
    unit = metadata[key].get("GwyDataField", {}).get("si_unit_z", {}).get("GwySIUnit", {})
    return str(unit.get("unitstr", ""))


def first(names: Collection[str]) -> str:
    """Return the first ten of some names and the number of all, for a message."""
    more = f", … ({len(names)} in all)" if len(names) > 10 else ""
    return ", ".join(islice(names, 10)) + more or "nothing"
