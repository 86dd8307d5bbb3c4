"""Pictures of a fit: each with its caption, beside each other in one file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pellicle.report.plotting import save_figure

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

SIZE = (5.2, 4.6)
"""Of a picture [inch]."""


class Drawn(NamedTuple):
    """A picture that is to be drawn."""

    draw: Callable[[FigureBase], None]
    caption: str


def save(pictures: Sequence[Drawn], path: Path) -> Path:
    """Write pictures beside each other and return the file.

    Raises
    ------
    StorageError
        The file cannot be written.
    """

    def fill(figure: FigureBase) -> None:
        parts = figure.subfigures(1, len(pictures), squeeze=False)
        for each, part in zip(pictures, parts[0], strict=True):
            each.draw(part)

    size = len(pictures) * SIZE[0], SIZE[1]
    (file,) = save_figure(fill, path.with_suffix(""), [path.suffix[1:]], size)
    return file
