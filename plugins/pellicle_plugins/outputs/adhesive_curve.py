"""The adhesive contact that follows from a path without adhesion."""

from __future__ import annotations

import textwrap
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from pellicle import analysis
from pellicle.arrays import Array
from pellicle.components import Runs
from pellicle.errors import ConfigError
from pellicle.results.result import Result
from pellicle.results.wording import is_periodic
from pellicle.show.style import colour, sparse_marker
from pellicle.units import Quantity, axis_unit
from pellicle_plugins.validation.adhesive_path import curve_of

from .base import Label, TableFigure, set_scales, write_csv

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_HEADS = "curve", "contact_radius [m]", "depth [m]", "force [N]"
_SUMMARY_HEADS = (
    "curve",
    "work_of_adhesion [J/m2]",
    "pull_off_force [N]",
    "pull_off_radius [m]",
    "pull_off_depth [m]",
    "zero_load_radius [m]",
    "zero_load_depth [m]",
    "fixed_depth_force [N]",
    "fixed_depth_radius [m]",
    "fixed_depth_depth [m]",
    "status",
)
_CELLS = 12
"""Contact radius in cells below which force and radius may be off by more than 2 %."""
_STEEP = 0.3
"""Slope above which linear elasticity is beyond its range."""
_LINE = 70
"""Letters of a line of text across the figure."""
_MARKERS = {"pull-off": "o", "no load": "s", "last at fixed depth": "v"}


class _Drawn(NamedTuple):
    """The path of a run and its adhesive curve, without points if the path has none."""

    name: Label
    colour: Any
    path: xr.Dataset
    curve: analysis.AdhesiveCurve | None
    points: dict[str, analysis.AdhesiveContact]
    """Pull-off, zero load and the instability at fixed depth, NaN where unknown."""
    status: str


class AdhesiveCurve(TableFigure):
    """Force against depth of an indenter that sticks, computed from its path without adhesion.

    `pellicle.analysis.adhesive_curve` has the equations, for an axisymmetric contact on a free
    boundary and any kernel. The run needs ``stiffness = true`` in its loading and at least eight
    steps; the curve covers the contact radii of the path. The figure ends at a push as large as the
    strongest pull; the whole curve is written as CSV beside it. ``-summary.csv`` has pull-off, the
    contact without load and the last contact at a fixed depth, with NaN and a status for what the
    path does not contain, its cells do not resolve, or is too steep for linear elasticity.
    """

    type: Literal["adhesive_curve"] = "adhesive_curve"
    examples = ({"work_of_adhesion": "50 mJ/m^2"},)
    work_of_adhesion: Annotated[
        float,
        Quantity("J/m2", above=0),
        Field(description="energy per area that separates indenter and solid [J/m2]"),
    ]

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the figure, of the curve and of its summary."""
        return (*super().suffixes, "-summary.csv")

    def check(self, runs: Runs) -> None:
        """Refuse runs that have no adhesive curve."""
        for *_, run in self.opened(runs):
            _refuse(run)

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figure, the curve and its summary."""
        paths, ordered = list(self.opened(runs)), self.is_ordered(runs)
        drawn = [
            self._drawn(name, colour(number, len(paths), ordered=ordered), run)
            for number, (name, _, run) in enumerate(paths)
        ]
        files = self.save(lambda figure: self._fill(figure.add_subplot(), drawn), stem)
        rows = (
            (d.name.key, *row)
            for d in drawn
            if d.curve
            for row in zip(d.curve.contact_radius, d.curve.depth, d.curve.force, strict=True)
        )
        summary = []
        for d in drawn:
            pull_off, zero_load, fixed_depth = d.points.values()
            ends = [(c.force, c.contact_radius, c.depth) for c in (pull_off, fixed_depth)]
            unloaded = zero_load.contact_radius, zero_load.depth
            summary.append(
                (d.name.key, self.work_of_adhesion, *ends[0], *unloaded, *ends[1], d.status)
            )
        return (
            *files,
            write_csv(stem, _HEADS, rows),
            write_csv(stem.with_name(f"{stem.name}-summary"), _SUMMARY_HEADS, summary),
        )

    def _drawn(self, name: Label, hue: Any, run: xr.Dataset) -> _Drawn:
        _refuse(run)
        path = run.isel(step=run["converged"].values & (run["contact_area"].values > 0))
        try:
            curve = curve_of(path, self.work_of_adhesion)
        except ConfigError as error:
            unknown = analysis.AdhesiveContact(*np.full(3, np.nan))
            return _Drawn(name, hue, path, None, dict.fromkeys(_MARKERS, unknown), str(error))
        contacts = curve.instability(), curve.at_zero_load(), curve.instability(inf)
        points = dict(zip(_MARKERS, contacts, strict=True))
        return _Drawn(name, hue, path, curve, points, _status(curve, points, path))

    def _fill(self, axes: Axes, drawn: list[_Drawn]) -> None:
        curves = [d.curve for d in drawn if d.curve is not None]
        depths = [np.zeros(1), *(d.path["depth"].values for d in drawn), *(c.depth for c in curves)]
        forces = [np.zeros(1), *(d.path["force"].values for d in drawn), *(c.force for c in curves)]
        length, length_name = axis_unit(np.concatenate(depths), "m")
        newton, newton_name = axis_unit(np.concatenate(forces), "N")
        for d in drawn:
            path = d.path["depth"].values * length, d.path["force"].values * newton
            axes.plot(*path, "--", color=d.colour, linewidth=0.8)
        for number, d in enumerate(drawn):
            if d.curve is None:
                continue
            end = d.points["last at fixed depth"].contact_radius
            # Without that point on the curve all of it is stable at a fixed depth.
            stable = ~(d.curve.contact_radius < end)
            x, y = d.curve.depth * length, d.curve.force * newton
            shared = {"color": d.colour, "linewidth": 1.4}
            marked = sparse_marker(number) if len(drawn) > 1 else {}
            axes.plot(x[stable], y[stable], "-", label=d.name.words or None, **shared, **marked)
            axes.plot(x[~stable], y[~stable], ":", **shared)
            for mark, contact in d.points.items():
                at = contact.depth * length, contact.force * newton
                axes.plot(*at, _MARKERS[mark], color=d.colour, markersize=5, mfc="white")
        hue = "0.4" if len(drawn) != 1 else drawn[0].colour
        if curves:
            axes.plot([], [], "-", color=hue, linewidth=1.4, label="with adhesion")
            axes.plot([], [], ":", color=hue, linewidth=1.4, label="unstable at fixed depth")
            for mark, marker in _MARKERS.items():
                axes.plot([], [], marker, color=hue, markersize=5, mfc="white", label=mark)
        axes.plot([], [], "--", color=hue, linewidth=0.8, label="without adhesion")
        axes.axhline(0.0, color="0.6", linewidth=0.6)
        axes.set(xlabel=f"depth [{length_name}]", ylabel=f"force [{newton_name}]", title=self.title)
        set_scales(axes, ())
        strongest = -min((curve.force.min() for curve in curves), default=0.0)
        if strongest > 0:
            # Curves are shown up to a push as large as the strongest pull.
            shown = np.concatenate([curve.depth[curve.force <= strongest] for curve in curves])
            left, right = shown.min() * length, shown.max() * length
            margin = 0.05 * (right - left)
            axes.set_xlim(left - margin, right + margin)
            axes.set_ylim(-1.1 * strongest * newton, 1.1 * strongest * newton)
        axes.legend(frameon=False, fontsize="small", loc="upper left")
        problems = dict.fromkeys(d.status for d in drawn if d.curve is None)
        text = "\n".join(textwrap.fill(problem, _LINE) for problem in problems)
        axes.text(0.02, 0.02, text, color="red", fontsize="small", transform=axes.transAxes)


def _status(
    curve: analysis.AdhesiveCurve, points: dict[str, analysis.AdhesiveContact], path: xr.Dataset
) -> str:
    """Return which points are not on the path, not resolved, or steeper than the theory allows."""
    spacing = max(Result(path).grid.spacing)
    steps = np.argsort(path["contact_radius"].values)
    slopes = path["contact_radius"].values[steps], _steepest_slopes(path)[steps]
    missing, coarse, steep = [], [], []
    for mark, contact in points.items():
        radius = float(contact.contact_radius)
        slope = float(np.interp(radius, *slopes))
        if np.isnan(radius):
            missing.append(mark)
            continue
        if radius < _CELLS * spacing:
            coarse.append(f"{mark} {radius / spacing:.1f}")
        if slope > _STEEP:
            steep.append(f"{mark} {slope:.2f}")
    low, high = curve.contact_radius[[0, -1]]
    range_ = f"not at a contact radius from {low:.3g} to {high:.3g} m, those of the path"
    remedy = f"from {_CELLS} on force and radius are good to 2 %, so use more points"
    theory = f"the theory is for small slopes, below about {_STEEP}"
    problems = {
        f"{', '.join(missing)}: {range_}": missing,
        f"contact radius in cells: {', '.join(coarse)}; {remedy}": coarse,
        f"slope of the indenter at the rim: {', '.join(steep)}; {theory}": steep,
    }
    return "; ".join(text for text, marks in problems.items() if marks) or "computed"


def _steepest_slopes(path: xr.Dataset) -> Array:
    """Return the largest slope of the indenter in the contact of each load step, shape (step,)."""
    last = path.isel(step=-1)
    profile = last["displacement"].values - last["depth"].item() - last["gap"].values
    spacing = Result(path).grid.spacing
    # Where the indenter ends the profile is −inf, and in the cells beside that the slope is inf.
    with np.errstate(invalid="ignore"):
        slope = np.hypot(*np.gradient(profile, *spacing))
    contacts = path["contact"].values
    return np.array([np.nanmax(slope[contact], initial=0.0) for contact in contacts])


def _refuse(run: xr.Dataset) -> None:
    """Refuse a run that has no adhesive curve, however many steps are solved."""
    if run.attrs["adheres"]:
        raise ConfigError(
            "adds adhesion to a path without it, and this run has an [interaction]; leave one out"
        )
    if is_periodic(run):
        raise ConfigError(
            'holds for one contact on an infinite surface; set grid.boundary = "free"'
        )
    if "stiffness" not in run:
        raise ConfigError("needs the stiffness of each step; set loading.stiffness = true")
