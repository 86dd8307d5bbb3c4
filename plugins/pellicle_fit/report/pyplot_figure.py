"""A figure of pyplot that a function returns and a notebook shows once."""

from __future__ import annotations

import matplotlib
from matplotlib import pyplot
from matplotlib.figure import Figure


class PyplotFigure(Figure):
    """A figure that leaves pyplot when a cell of a notebook displays it.

    The inline backend displays all figures of pyplot at the end of a cell, after IPython has
    displayed the value of the last line.
    """

    def _ipython_display_(self) -> None:
        """Close the figure in pyplot if that would display it a second time.

        Raises
        ------
        NotImplementedError
            Always: IPython then displays it as any other figure.
        """
        if "inline" in matplotlib.get_backend():
            pyplot.close(self)
        raise NotImplementedError
