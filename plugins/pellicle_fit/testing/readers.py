"""The contract of readers as a test: one call checks a reader, with files that it reads."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

from pellicle.errors import PellicleError
from pellicle.testing import check, rules_of
from pellicle_fit.files.columns import Calibration
from pellicle_fit.files.measurement import Measurement
from pellicle_fit.files.reader import Reader

_CUTS = 12
"""Lengths at which a file is cut."""
_DAMAGES = 40
"""Copies of a file with bytes that were changed."""


def check_reader(reader: Reader, *paths: Path, calibration: Calibration | None = None) -> None:
    """Check that a reader keeps its contract, on files that it reads.

    Besides the rules of all components: its files are told from others; curves have labels, numbers
    and SI units; and a file that is cut, damaged or of another kind is an error in words. The
    files need the ``calibration``.
    """
    check(reader, Reader, rules_of(__name__), paths, calibration or Calibration())


def tells_its_files(reader: Reader, paths: Sequence[Path], calibration: Calibration) -> str:
    """sniff() is true of its files, and returns a bool for any other, or raises an OSError."""
    for path in paths:
        if reader.sniff(path) is not True and not reader.takes_columns:
            return f"sniff({path.name}) is {reader.sniff(path)!r}"
    sniffed: object = False
    with _copy(reader, b"\0" * 64) as other, suppress(OSError):
        sniffed = reader.sniff(other)
    return "" if isinstance(sniffed, bool) else f"sniff() returns {sniffed!r}"


def reads_curves(reader: Reader, paths: Sequence[Path], calibration: Calibration) -> str:
    """read() returns functions by labels, empty for one curve; each returns the same curve twice.

    Positions, forces and times are finite rows of one length, and no file is changed.
    """
    for path in paths:
        content = path.read_bytes()
        curves = reader.read(path, calibration)
        labels = list(curves) if isinstance(curves, Mapping) else []
        if not labels or not all(isinstance(label, str) for label in labels):
            return f"read({path.name}) returns {curves!r}, which maps no texts"
        if (labels == [""]) is not (len(labels) == 1):
            return f"{path.name} has the labels {labels}; one curve has the label ''"
        for label in (labels[0], labels[-1]):
            first, second = curves[label](), curves[label]()
            if not isinstance(first, Measurement):
                return f"curve {label!r} of {path.name} is {first!r}; `curve_of` makes one"
            for name in ("position", "force", "time"):
                first_array, two = getattr(first, name), getattr(second, name)
                if first_array is None and name == "time":
                    continue
                if first_array.shape != (first.force.size,) or not np.isfinite(first_array).any():
                    return f"{name} of curve {label!r} of {path.name} is {first_array!r}"
                if not np.array_equal(first_array, two, equal_nan=True):
                    return f"{name} of curve {label!r} of {path.name} differs the second time"
        if path.read_bytes() != content:
            return f"{path.name} was changed"
    return ""


def refuses_other_files_in_words(
    reader: Reader, paths: Sequence[Path], calibration: Calibration
) -> str:
    """A file that is empty, cut, damaged or of another kind raises nothing but PellicleError."""
    contents = [b"", b"\0" * 4096, b"no curve\n"]
    random = np.random.default_rng(0)
    for path in paths:
        whole = path.read_bytes()
        contents += [whole[: len(whole) * cut // _CUTS] for cut in range(1, _CUTS)]
        for _ in range(_DAMAGES):
            damaged = bytearray(whole)
            for at in random.integers(0, len(whole), 4):
                damaged[at] = random.integers(0, 256)
            contents.append(bytes(damaged))
    for content in contents:
        with _copy(reader, content) as copy, suppress(PellicleError):
            with suppress(OSError):
                reader.sniff(copy)
            for curve in reader.read(copy, calibration).values():
                curve()
    return ""


@contextmanager
def _copy(reader: Reader, content: bytes) -> Iterator[Path]:
    """Yield a file of some content with a suffix of a reader, in a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "file" + reader.suffixes[0].replace("[0-9]", "0"))
        path.write_bytes(content)
        yield path
