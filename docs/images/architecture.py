"""Draws ``architecture.png``: packages, folders of the framework, and the way of a value.

Packages and layers are read from the import contracts in ``pyproject.toml``. Run it as
``python docs/images/architecture.py``.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "framework" / "pellicle"
WAY = {
    "config": "1  a run file becomes a Run",
    "runs": "2  a Run becomes load steps, solved in turn",
    "contact": "3  a Problem is solved, and measured afresh",
    "results": "4  a step becomes a dataset, and lies on disk",
    "show": "5  figures and pages",
}
"""What happens to a value in the folders that it passes."""


def layers() -> list[list[str]]:
    """Return the plugins, then the modules of each layer of the framework, the highest first."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    folders, _, packages, *_ = project["tool"]["importlinter"]["contracts"]
    return [layer.split(" | ") for layer in (*packages["layers"][:-1], *folders["layers"])]


def main() -> None:
    """Draw."""
    rows = layers()
    figure = Figure(figsize=(8.4, 0.42 * len(rows) + 0.5), dpi=150)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, 100), ylim=(len(rows) + 0.2, -0.9))
    axes.axis("off")
    axes.text(50, -0.5, "imports go down only", ha="center", va="center", color="0.4", fontsize=8)
    for row, modules in enumerate(rows):
        width = 64 / len(modules)
        for column, module in enumerate(modules):
            is_folder = (PACKAGE / module).is_dir()
            on_the_way = module in WAY
            axes.add_patch(
                FancyBboxPatch(
                    (1 + column * width, row + 0.1),
                    width - 1.2,
                    0.8,
                    boxstyle="round,pad=0,rounding_size=0.25",
                    facecolor="#cfe3f4" if on_the_way else "#eef1f4" if is_folder else "white",
                    edgecolor="0.55",
                    linewidth=0.8,
                )
            )
            axes.text(
                1 + column * width + (width - 1.2) / 2,
                row + 0.52,
                module + ("/" if is_folder else ""),
                ha="center",
                va="center",
                fontsize=8,
                fontweight="bold" if on_the_way else "normal",
            )
            if on_the_way:
                axes.text(67, row + 0.52, WAY[module], va="center", fontsize=8)
    figure.savefig(Path(__file__).with_name("architecture.png"))


if __name__ == "__main__":
    main()
