"""Draws the figures of docs/performance.md from the tables in docs/measurements.

python docs/images/performance.py
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pellicle.show import save_figure
from pellicle.show.figure_style import MARKERS, OKABE_ITO

IMAGES = Path(__file__).parent
MEASUREMENTS = IMAGES.parent / "measurements"
POINTS = (64, 128, 256, 512, 1024)
Rows = list[dict[str, str]]


def read(name: str, **which: str) -> Rows:
    """Return the rows of a table of measurements, of which only those with these values."""
    lines = (MEASUREMENTS / f"{name}.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    return [row for row in rows if all(row[key] == value for key, value in which.items())]


def kind(kernel: str) -> int:
    """Return the number of the group of a kernel in `GROUPS`."""
    if kernel.startswith("bending_skin") or "B/E*" in kernel:
        return 3
    if kernel.startswith(("tensed", "coated", "gurtin")):
        return 2
    return int(kernel.startswith(("bonded", "frictionless", "layered")))


GROUPS = ("half-space, springs", "layers", "skins under tension", "skins that bend")


def draw_applications(figure: Figure) -> None:
    """Draw the operator applications against N, a line for each kernel."""
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, case in ((left, "rough"), (right, "free")):
        for row in read("kernels"):
            group = kind(row["kernel"])
            counts = [int(row[f"{case}_{points}"]) for points in POINTS]
            axes.semilogx(POINTS, counts, marker=MARKERS[group], color=OKABE_ITO[group], alpha=0.7,
                          markersize=4, markerfacecolor="white", linewidth=1)  # fmt: skip
        ticks(axes, POINTS)
        axes.set_title("rough, periodic" if case == "rough" else "paraboloid, free")
        axes.grid(alpha=0.3)
    left.set(ylabel="operator applications", ylim=(0, 42))
    for group, name in enumerate(GROUPS):
        left.plot([], [], marker=MARKERS[group], color=OKABE_ITO[group], label=name,
                  markerfacecolor="white")  # fmt: skip
    left.legend(fontsize="small", ncols=2, loc="upper left", frameon=False)


CODES = (
    "active_set",
    "conjugate_gradient",
    "ASPHER 0.1.3.post1",
    "tamaas 2.9.0",
    "ContactMechanics 1.8.3",
)


def draw_seconds(figure: Figure) -> None:
    """Draw the seconds of a solve against N, of pellicle and other codes."""
    panels = (("periodic", "0"), ("periodic", "0.02"), ("free", "0"))
    titles = ("periodic", "periodic, s = 0.02 L", "free")
    shown = figure.subplots(1, 3, sharey=True, width_ratios=(3, 1.6, 3))
    for axes, (boundary, s), title in zip(shown, panels, titles, strict=True):
        for number, code in enumerate(CODES):
            for threads, line in (("1", "-"), ("2", "--")):
                rows = read("codes", boundary=boundary, s_over_L=s, threads=threads, code=code)
                seconds = {int(row["N"]): float(row["seconds"]) for row in rows}
                axes.loglog(list(seconds), list(seconds.values()), line, marker=MARKERS[number],
                            color=OKABE_ITO[number], markersize=5,
                            markerfacecolor="white" if threads == "1" else None)  # fmt: skip
        ticks(axes, (512, 1024, 2048) if s == "0" else (512,))
        axes.set_title(title, fontsize="medium")
        axes.set_xlim(400, 2600 if s == "0" else 660)
        axes.grid(alpha=0.3)
    shown[0].set(ylabel="seconds", ylim=(0.06, 60))
    for number, code in enumerate(CODES):
        shown[2].plot([], [], marker=MARKERS[number], color=OKABE_ITO[number], label=code,
                      markerfacecolor="white")  # fmt: skip
    shown[2].plot([], [], "--", color="0.4", label="two threads")
    figure.legend(fontsize="small", ncols=3, loc="outside lower center", frameon=False)


SERIES = {
    "cold": "from nothing",
    "one_state": "from the last step",
    "two_states": "from the last two",
    "contact_known": "contact known beforehand",
}


def draw_steps(figure: Figure) -> None:
    """Draw the operator applications of a step of a path, without and with adhesion."""
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    rows = read("next_step")
    places = np.arange(len(rows))
    for number, (column, name) in enumerate(SERIES.items()):
        values = [float(row[column]) for row in rows]
        colour = OKABE_ITO[number] if column != "contact_known" else "0.7"
        left.bar(places + 0.2 * (number - 1.5), values, 0.2, label=name, color=colour)
    left.set(ylabel="operator applications of a step", title="N = 512, steps of 2 %", ylim=(0, 52))
    names(left, [f"{row['case']}\n{tension(row['s_over_L'])}" for row in rows])
    left.legend(fontsize="small", ncols=2, loc="upper left", frameon=False)
    rows = read("adhesion_steps")
    places = np.arange(len(rows))
    for number, points in enumerate(("128", "256")):
        mean, most = ([float(row[f"{name}_{points}"]) for row in rows] for name in ("mean", "most"))
        at = places + 0.4 * (number - 0.5)
        right.bar(at, mean, 0.4, label=f"mean, N = {points}", color=OKABE_ITO[number])
        right.plot(
            at, most, "_", color="black", label=None if number else "most, a step that jumps"
        )
    right.set(title="with adhesion (jkr)", ylim=(0, 750))
    cases = {"paraboloid": "bead", "rough punch": "punch"}
    names(right, [f"{cases[row['case']]}\n{row['s']}" for row in rows])
    right.legend(fontsize="small", loc="upper left", frameon=False)


def tension(s: str) -> str:
    """Return the elastocapillary length over the domain in words."""
    return {"0": "0", "1": "L"}.get(s, f"{s} L")


def ticks(axes: Axes, points: tuple[int, ...]) -> None:
    """Label the axis of N."""
    axes.set_xticks(points, [str(value) for value in points])
    axes.minorticks_off()
    axes.set_xlabel("cells along an edge, N")


def names(axes: Axes, labels: list[str]) -> None:
    """Label groups of bars."""
    axes.set_xticks(range(len(labels)), labels, fontsize="small")
    axes.grid(axis="y", alpha=0.3)


def main() -> None:
    """Draw all."""
    for name, draw, size in (
        ("applications", draw_applications, (7.4, 3.4)),
        ("seconds", draw_seconds, (7.4, 3.8)),
        ("steps", draw_steps, (8.4, 3.4)),
    ):
        save_figure(draw, IMAGES / "performance" / name, ["png"], size)


if __name__ == "__main__":
    main()
