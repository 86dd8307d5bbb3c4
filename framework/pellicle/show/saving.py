"""Figures as files and as SVG."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from pellicle.files import atomic_write, for_document, storage_errors

from .style import FigureStyle, label_log_axes, lay_out

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = 5.4, 4.2
"""Width and height of a figure [inch], unless it needs more."""


def save_figure(
    draw: Callable[[Figure], None],
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
    draws: Iterable[Callable[[Figure], None]], path: Path, size: tuple[float, float]
) -> Path:
    """Let each function fill a page of ``size`` [inch] of a PDF file, and return the file."""
    from matplotlib.backends.backend_pdf import PdfPages

    # The fonts are embedded as the file is closed, after the figures.
    with (
        atomic_write(path) as part,
        FigureStyle().applied(),
        PdfPages(part, metadata={"CreationDate": None}) as file,
    ):
        for draw in draws:
            with _figure(draw, size) as figure:
                file.savefig(figure)
    return path


def svg(draw: Callable[[Figure], None], size: tuple[float, float] = SIZE) -> bytes:
    """Let ``draw`` fill a figure of ``size`` [inch], and return it as reproducible SVG."""
    import matplotlib as mpl

    # A page cannot count on the fonts of its reader.
    with mpl.rc_context(), _figure(draw, size, FigureStyle(svg_text=False)) as figure:
        mpl.rcParams["svg.hashsalt"] = "pellicle"
        buffer = BytesIO()
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


@contextmanager
def _figure(
    draw: Callable[[Figure], None], size: tuple[float, float], style: FigureStyle | None = None
) -> Iterator[Figure]:
    """Yield a figure that ``draw`` has filled; it is empty afterwards."""
    from matplotlib.figure import Figure
    from matplotlib.text import Text

    style = style or FigureStyle()
    with style.applied():
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
            figure.clear()
