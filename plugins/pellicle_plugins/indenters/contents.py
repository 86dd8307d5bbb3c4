"""What a file holds in place of heights, for a message that says what to do."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path
from typing import Any

from .file_checks import HDF5, datasets

_SAVE = "save heights with numpy.save and give them as type = 'heights'"
_TIFF = b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"


def contents(path: Path, metadata: dict[str, Any]) -> str:
    """Return what a file without heights holds, as far as its format or ``metadata`` tell."""
    with path.open("rb") as file:
        head = file.read(8)
    if head.startswith(_TIFF):
        return f"is a TIFF image without a scale of heights; {_SAVE}"
    if head == HDF5:
        with datasets(path) as arrays:
            names = [f"{name!r} of shape {array.shape}" for name, array in arrays.items()]
        return f"holds no 2-D array of real numbers, but {_first(names)}; {_SAVE}"
    if head.startswith(b"GWYP"):
        names = [
            f"{metadata.get(f'{key}/title', key)!r} in {unit_of_image(metadata, key) or 'no unit'}"
            for key in filter(re.compile(r"/\d+/data").fullmatch, metadata)
        ]
        return f"holds no image of heights, but {_first(names)}; give another"
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


def _first(names: list[str]) -> str:
    return ", ".join(names[:6]) + ", …" * (len(names) > 6) or "nothing"
