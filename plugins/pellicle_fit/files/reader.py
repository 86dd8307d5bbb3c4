"""The contract of readers: files of one kind, and how their curves are read."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Mask
from pellicle.components import Component
from pellicle.errors import PluginError, StorageError

from .columns import Calibration as Calibration
from .columns import Column, from_columns, missing_parts, recalibrate
from .measurement import CurvesByLabel as CurvesByLabel
from .measurement import Measurement as Measurement
from .measurement import Site as Site
from .missing import OPTIONS, MissingInputError

DRIVEN = (
    "the file holds no height that was measured, only that to which the piezo was driven; without "
    "a closed loop its motion differs from that by 10 to 50 %, and the modulus by as much"
)
"""Warning of a curve whose height is not that of a sensor."""


class Reader(Component):
    """Reads the curves in files of one kind, which suffix and content tell."""

    family: ClassVar[str] = "reader"
    place: ClassVar[str] = ""
    suffixes: ClassVar[tuple[str, ...]]
    """Suffixes of its files in lower case, or patterns such as ``.[0-9][0-9][0-9]``."""
    takes_columns: ClassVar[bool] = False
    """Whether a user may name the columns of its files; such a reader is asked after the others."""

    def sniff(self, path: Path) -> bool:
        """Return whether a file with one of the suffixes is of this kind; by default it is."""
        return True

    @abstractmethod
    def read(self, path: Path, calibration: Calibration) -> CurvesByLabel:
        """Return what reads each curve of a file, one at a time, by its label.

        The label is empty where a file holds one curve. ``calibration`` is what the user
        gives, which `curve_of` takes. A file that cannot be read is a StorageError.
        """

    @classmethod
    def check_class(cls) -> None:
        """Refuse a class without suffixes."""
        suffixes = getattr(cls, "suffixes", ())
        good = isinstance(suffixes, tuple) and all(
            isinstance(text, str) and text.startswith(".") and text == text.lower()
            for text in suffixes
        )
        if not (suffixes and good):
            raise PluginError(f'{cls.__name__}.suffixes has to be a tuple such as (".spm",)')


def curve_of(
    path: Path,
    columns: Mapping[str, tuple[ArrayLike, str]],
    calibration: Calibration,
    *,
    spring_constant: float | None = None,
    sensitivity: float | None = None,
    site: Site | None = None,
    pause: Mask | None = None,
    messages: tuple[str, ...] = (),
) -> Measurement:
    """Return the curve that the columns of a file make, each with its unit, by their roles.

    A force is ``force`` or ``deflection``, in volts with the sensitivity [m/V]. The place is that
    of the tip, ``position``, which grows into the solid, or that of the base, ``extension`` or
    minus ``height``. Time is ``time``. The sensitivity that is given replaces that of the file, and
    the spring constant [N/m] that is given scales the force.

    Raises
    ------
    ConfigError
        Something is missing, has a wrong unit or is given for nothing.
    """
    made = {
        role: Column("", role, unit, np.asarray(values, dtype=float))
        for role, (values, unit) in columns.items()
    }
    own = Calibration(
        spring_constant=spring_constant or calibration.spring_constant,
        sensitivity=calibration.sensitivity or sensitivity,
        speed=calibration.speed,
    )
    if lacks := missing_parts(made, own):
        raise MissingInputError(f"{path}: ", {name: OPTIONS.get(name, "") for name in lacks})
    curve = replace(from_columns(made, own), site=site, pause=pause, messages=messages)
    return recalibrate(curve, calibration, is_own=True)


def sections_of(
    path: Path, section: re.Pattern[str], end: bytes, longest: int
) -> tuple[int, list[tuple[str, str]]]:
    """Return where a header ends, and name and text of its sections in order.

    Titles are what ``section`` matches, a name its only group. A header that does not ``end``
    within so many bytes is a ValueError.
    """
    with path.open("rb") as file:
        beginning = file.read(longest)
    length = beginning.find(end)
    if length < 0:
        raise ValueError("its header does not end")
    parts = section.split(beginning[:length].decode("latin-1").replace("\r\n", "\n"))
    return length, [*zip(parts[1::2], parts[2::2], strict=True)]


@contextmanager
def reading(path: Path, kind: str) -> Iterator[None]:
    """Raise a StorageError, with the reason in words, where a file cannot be read as ``kind``."""
    try:
        yield
    except (OSError, ValueError, LookupError, OverflowError) as error:
        reason = getattr(error, "strerror", "") or " ".join(map(str, error.args))
        lacks = "it has no " if isinstance(error, KeyError) else ""
        raise StorageError(f"{path}: cannot be read as {kind} ({lacks}{reason})") from None
