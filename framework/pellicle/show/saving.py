"""Figures as files and as SVG."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.components.charts import Chart, Fields, Shown, Table
from pellicle.errors import PluginError
from pellicle.files import atomic_write, for_document, storage_errors

from .drawing import SIZE, PlacedSeries, draw, size_of
from .figure_style import FigureStyle, label_log_axes, lay_out
from .numbers import table_of, write_csv

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_charts(
    shown: Iterable[tuple[str, Shown]],
    stem: Path,
    formats: Iterable[str] = ("png",),
    style: FigureStyle | None = None,
) -> tuple[Path, ...]:
    """Write what an output shows, each under its suffix; return the files.

    Charts and fields become figures in each format, tables CSV; bytes are written as they are, and
    their suffix ends like a file name. The numbers of a chart are written beside it, unless a table
    with its suffix came before.
    """
    files: list[Path] = []
    figures_written = set[Path]()
    # One after the other, so that one at a time is in memory.
    for suffix, part in shown:
        path = stem.with_name(f"{stem.name}{suffix}")
        numbers = path.with_name(f"{path.name}.csv")
        if isinstance(part, bytes):
            with storage_errors(path):
                path.write_bytes(part)
            files.append(path)
        elif isinstance(part, Table):
            files.append(write_csv(part, numbers))
        elif path in figures_written:
            raise PluginError(f"two figures have the suffix {suffix!r}; give each its own")
        else:
            figures_written.add(path)
            fill, size = figure_of(part)
            files += save_figure(fill, path, formats, size, style)
            if isinstance(part, Chart) and numbers not in files:
                files.append(write_csv(table_of(part), numbers))
    return tuple(files)


def figure_of(
    shown: Chart | Fields | Sequence[Chart | Fields], *, titled: bool = True
) -> tuple[Callable[[Figure], list[PlacedSeries]], tuple[float, float]]:
    """Return what fills a figure with charts and fields side by side, and its size [inch]."""
    beside = [shown] if isinstance(shown, (Chart, Fields)) else shown
    beside = beside if titled else [replace(part, title="") for part in beside]

    def fill(figure: Figure) -> list[PlacedSeries]:
        places: Any = [figure] if len(beside) == 1 else figure.subfigures(1, len(beside))
        parts = zip(places, beside, strict=True)
        return [drawn for place, part in parts for drawn in draw(place, part)]

    sizes = [size_of(part) for part in beside]
    return fill, (sum(width for width, _ in sizes), max(height for _, height in sizes))


def save_figure(
    draw: Callable[[Figure], object],
    stem: Path,
    formats: Iterable[str],
    size: tuple[float, float] = SIZE,
    style: FigureStyle | None = None,
) -> tuple[Path, ...]:
    """Let ``draw`` fill a figure of ``size`` [inch], and write it as ``stem.format``.

    The width of a ``style`` replaces that of ``size``, with the height in proportion.
    """
    files = []
    with _figure(draw, size, style) as figure:
        for format_ in formats:
            path = stem.with_name(f"{stem.name}.{format_}")
            with storage_errors(path):
                path.parent.mkdir(parents=True, exist_ok=True)
                figure.savefig(path)
            files.append(path)
    return tuple(files)


def save_pages(
    draws: Iterable[Callable[[Figure], object]], path: Path, size: tuple[float, float]
) -> Path:
    """Let each function fill a page of ``size`` [inch] of a PDF file, and return the file."""
    from matplotlib.backends.backend_pdf import PdfPages

    # The fonts are embedded as the file is closed, after the figures.
    with (
        atomic_write(path) as part,
        FigureStyle().apply_style(),
        PdfPages(part, metadata={"CreationDate": None}) as file,
    ):
        for draw in draws:
            with _figure(draw, size) as figure:
                file.savefig(figure)
    return path


def svg(
    draw: Callable[[Figure], object],
    size: tuple[float, float] = SIZE,
    laid_out: Callable[[Figure], object] | None = None,
) -> bytes:
    """Let ``draw`` fill a figure of ``size`` [inch], and return it as reproducible SVG.

    ``laid_out`` is given the figure when all has its final place.
    """
    import matplotlib as mpl

    # A page cannot count on the fonts of its reader.
    with mpl.rc_context(), _figure(draw, size, FigureStyle(svg_text=False)) as figure:
        if laid_out:
            laid_out(figure)
        mpl.rcParams["svg.hashsalt"] = "pellicle"
        buffer = BytesIO()
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def png(shown: Chart | Fields) -> bytes:
    """Return a drawing as PNG, as a notebook shows it."""
    buffer = BytesIO()
    with _figure(*figure_of(shown)) as figure:
        figure.savefig(buffer, format="png")
    return buffer.getvalue()


@contextmanager
def _figure(
    draw: Callable[[Figure], object], size: tuple[float, float], style: FigureStyle | None = None
) -> Iterator[Figure]:
    """Yield a figure that ``draw`` has filled; it is empty afterwards."""
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage
    from matplotlib.text import Text

    style = style or FigureStyle()
    with style.apply_style():
        figure = Figure(figsize=style.size(size), dpi=150, layout="constrained")
        draw(figure)
        # SVG repeats every text in a comment of its XML.
        for text in figure.findobj(Text):
            text.set_text(for_document(text.get_text()))
        label_log_axes(figure)
        lay_out(figure)
        try:
            yield figure
        finally:
            # Artists refer to each other, so the fields that they draw would outlive the figure.
            for image in figure.findobj(AxesImage):
                image.set_data(np.zeros((1, 1)))
            figure.clear()
