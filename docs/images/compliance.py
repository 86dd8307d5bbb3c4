"""Draws paper/fig2.png: the compliance of cells in Fourier space, beside the kernel's formula.

python docs/images/compliance.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import scipy.fft
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.arrays import Array
from pellicle.show import save_figure
from pellicle.show.figure_style import MARKERS

MODULUS = 10e3
TENSIONS = 0.0, 0.1, 1.0
# The transform over the domain swings about the formula by about s/L, so the domain is large.
GRID = pl.Grid(points=1024, size="20 mm")


def kernel_of(tension: float) -> pl.Kernel:
    """Return the solid of the figure under a tension [N/m]."""
    return pl.kernel("tensed_membrane", reduced_modulus=MODULUS, tension=tension)


def along_x(kernel: pl.Kernel, grid: pl.Grid) -> tuple[Array, Array]:
    """Return wavenumbers q > 0 along x [rad/m] and the compliance of the cells there [m/Pa].

    The compliance is the discrete Fourier transform of the displacement under a unit pressure on
    the cell in the middle, cut off at half of the domain on each side.
    """
    middle = tuple(n // 2 for n in grid.shape)
    pressure = np.zeros(grid.shape)
    pressure[middle] = 1.0
    response = pl.displacement(pressure, kernel=kernel, grid=grid)
    compliance = scipy.fft.rfft(np.roll(response.sum(axis=1), -middle[0])).real[1:]
    return abs(grid.wavenumbers()[0].ravel()[1 : compliance.size + 1]), compliance


def main() -> None:
    """Compute and draw."""
    save_figure(draw, Path(__file__).with_name("paper") / "fig2", ["png"])


def draw(figure: Figure) -> None:
    """Draw markers for the cells and a line for the formula, for each tension."""
    axes = figure.add_subplot()
    for index, tension in enumerate(TENSIONS):
        kernel = kernel_of(tension)
        q, compliance = along_x(kernel, GRID)
        marked = np.unique(np.geomspace(1, q.size, 40).astype(int)) - 1
        label = f"s = {2e6 * tension / MODULUS:.3g} µm"
        shape = {"marker": MARKERS[index], "markersize": 3.5, "markerfacecolor": "white"}
        axes.loglog(q[marked], compliance[marked], linestyle="none", label=label, **shape)
        axes.loglog(q, kernel.compliance(q), color="black", linewidth=1.0, zorder=1)
    axes.plot([], [], color="black", linewidth=1.0, label="formula")
    axes.set(xlabel="wavenumber ω [rad/m]", ylabel="compliance Ĝ(ω) [m/Pa]")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")


if __name__ == "__main__":
    main()
