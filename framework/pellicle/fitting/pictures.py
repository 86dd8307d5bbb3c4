"""Pictures of a fit: each with its width and its caption, beside each other in one file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pellicle.plotting import save_figure

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

HEIGHT = 4.6
"""Of a picture [inch]."""


class Drawn(NamedTuple):
    """A picture that is to be drawn."""

    draw: Callable[[FigureBase], None]
    width: float
    """[inch]"""
    caption: str


def save(pictures: Sequence[Drawn], path: Path) -> Path:
    """Write pictures beside each other and return the file.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    widths = [each.width for each in pictures]

    def fill(figure: FigureBase) -> None:
        parts = figure.subfigures(1, len(widths), squeeze=False, width_ratios=widths)
        for each, part in zip(pictures, parts[0], strict=True):
            each.draw(part)

    (file,) = save_figure(fill, path.with_suffix(""), [path.suffix[1:]], (sum(widths), HEIGHT))
    return file
