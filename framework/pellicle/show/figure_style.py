"""Colours, sizes and tick labels of figures, legible in print, in grey and to the colour-blind."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field

from pellicle.errors import ConfigError
from pellicle.schema.from_file import InputPath
from pellicle.schema.model import Model
from pellicle.units import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

OKABE_ITO = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"
"""Colours that the colour-blind tell apart (Okabe & Ito 2008), without the yellow."""
NO_CONTACT = "0.93"
"""Grey of cells without contact."""
MARKERS = "os^Dv<>P"
LINES = ("-", "--", "-.", ":")
_SMALL = 8.0
_LIGHTEST = 0.8
_LABELLED_DECADES = 2.2


class FigureStyle(Model):
    """How figures are set for print."""

    width: Annotated[float, Quantity("m", at_least=0.02, at_most=1.0)] | None = Field(
        None, description="width of the figure, such as 85 mm or 170 mm [m]"
    )
    font_size: float | None = Field(
        None,
        ge=3,
        le=40,
        description="size of the text in points; if absent 8 with a width, else as in file",
    )
    svg_text: bool = Field(
        True, description="whether text in SVG stays text, which can be edited, or becomes paths"
    )
    file: InputPath | None = Field(None, description="a style file of matplotlib (.mplstyle)")

    def size(self, size: tuple[float, float]) -> tuple[float, float]:
        """Return the size of a figure [inch], scaled to the width."""
        if self.width is None:
            return size
        width = self.width / 0.0254
        return width, size[1] * width / size[0]

    @contextmanager
    def apply_style(self) -> Iterator[None]:
        """Apply the style to what is drawn inside the context."""
        import matplotlib as mpl
        import matplotlib.style
        from cycler import cycler

        from_file: Any = {}
        if self.file is not None:
            try:
                # Unknown keys are logged; bad values raise.
                from_file = mpl.rc_params_from_file(self.file, True, False)
            except (OSError, ValueError) as error:
                raise ConfigError(
                    f"{self.file} cannot be read as a style file of matplotlib: {error}",
                    "style.file",
                ) from None
        house: dict[str, Any] = {
            "axes.prop_cycle": cycler(color=OKABE_ITO),
            "legend.frameon": False,
            "pdf.fonttype": 42,
        }
        own: dict[str, Any] = {"svg.fonttype": "none" if self.svg_text else "path"}
        font_size = _SMALL if self.font_size is None and self.width else self.font_size
        if font_size is not None:
            own["font.size"] = font_size
        with mpl.style.context(["default", house, dict(from_file), own]):
            yield


def colour(number: int, count: int, *, ordered: bool = False) -> Any:
    """Return the colour of one of ``count`` curves.

    The colours of ordered values get lighter evenly; the others are those of the cycle.
    """
    import matplotlib as mpl

    if count > len(mpl.rcParams["axes.prop_cycle"]) or (ordered and count > 2):
        return mpl.colormaps["viridis"](_LIGHTEST * number / max(count - 1, 1))
    return f"C{number}"


def label_log_axes(figure: Figure) -> None:
    """Label also ticks between the powers of ten on logarithmic axes of about two decades."""
    from matplotlib.ticker import LogLocator, StrMethodFormatter

    for axes in figure.axes:
        for axis, scale in ((axes.xaxis, axes.get_xscale()), (axes.yaxis, axes.get_yscale())):
            if scale != "log" or not isinstance(axis.get_minor_locator(), LogLocator):
                continue
            low, high = sorted(axis.get_view_interval())
            decades = np.log10(high / low)
            if decades > _LABELLED_DECADES or not 1e-3 <= low <= high <= 1e5:
                continue
            between = range(2, 10) if decades < 0.5 else (2, 3, 5, 7) if decades < 1 else (2, 5)
            axis.set_minor_locator(LogLocator(subs=between, numticks=50))
            axis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axis.set_minor_formatter(StrMethodFormatter("{x:g}"))


def lay_out(figure: Figure) -> None:
    """Give the axes of a figure their places, with legends that lie on a curve beside them.

    The layout is final: matplotlib would draw the whole figure once more for that of each file.
    """
    engine = figure.get_layout_engine()
    if engine is None:
        return
    engine.execute(figure)
    if any(axes.get_aspect() != "auto" for axes in figure.axes):
        # Axes of a fixed aspect move, with their titles and labels, as they get their places.
        engine.execute(figure)
    is_moved = False
    for axes in figure.axes:
        legend = axes.get_legend()
        if not legend:
            continue
        box = legend.get_window_extent()
        artists: list[Any] = [*(line for line in axes.lines if line.get_visible()), *axes.patches]
        for artist in artists:
            path = artist.get_path().transformed(artist.get_transform())
            finite = np.isfinite(path.vertices).all(axis=1)
            if finite.any() and path.intersects_bbox(box, filled=False):
                legend.set_loc("upper left")
                legend.set_bbox_to_anchor((1.01, 1.0), transform=axes.transAxes)
                is_moved = True
                break
    if is_moved:
        engine.execute(figure)
    figure.set_layout_engine("none")
