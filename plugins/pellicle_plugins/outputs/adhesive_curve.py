"""The adhesive contact that follows from a path without adhesion."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import replace
from math import inf
from typing import Annotated, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import Field

from pellicle.analysis import steepest
from pellicle.arrays import Dataset
from pellicle.components import Axis, Chart, Look, Runs, Series, Shown, Table
from pellicle.errors import ConfigError
from pellicle.results import FEW_CELLS, Result, is_periodic
from pellicle.units import Quantity
from pellicle_axisymmetric import AdhesiveContact
from pellicle_axisymmetric import AdhesiveCurve as AxisymmetricCurve
from pellicle_plugins.validation.adhesive_path import curve_of

from .base import Label, TableFigure

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
_LINE = 70
"""Letters of a line of text across the figure."""
_STEEP_RIM = 0.3
"""Slope above which linear elasticity is beyond its range."""
_MARKERS = {"pull-off": 0, "no load": 1, "last at fixed depth": 4}


class _Drawn(NamedTuple):
    """The path of a run and its adhesive curve, without points if the path has none."""

    name: Label
    path: Dataset
    curve: AxisymmetricCurve | None
    points: dict[str, AdhesiveContact]
    """Pull-off, zero load and the instability at fixed depth, NaN where unknown."""
    status: str


class AdhesiveCurve(TableFigure):
    """Force against depth of an indenter that sticks, computed from its path without adhesion.

    `pellicle_axisymmetric.adhesive_curve` has the equations, for an axisymmetric contact on a free
    boundary and any kernel. The run needs ``stiffness = true`` in its loading and at least eight
    steps; the curve covers the contact radii of the path. The figure ends at a push as large as the
    strongest pull; the whole curve is written as CSV beside it. ``-summary.csv`` has pull-off, the
    contact without load and the last contact at a fixed depth, with NaN and a status for what the
    path does not contain, its cells do not resolve, or is too steep for linear elasticity.
    """

    type: Literal["adhesive_curve"] = "adhesive_curve"
    of_contact: ClassVar[bool] = True
    examples = ({"work_of_adhesion": "50 mJ/m^2"},)
    work_of_adhesion: Annotated[float, Quantity("J/m2", above=0)] = Field(
        description="energy per area that separates indenter and solid [J/m2]"
    )

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the figure, of the curve and of its summary."""
        return (*super().suffixes, "-summary.csv")

    def charts(self, runs: Runs) -> Iterator[tuple[str, Shown]]:
        """Yield the curves, and the tables of their points and of their ends."""
        drawn = [self._drawn(name, run) for name, _, run in self.open_runs(runs)]
        rows = [
            (d.name.key, *row)
            for d in drawn
            if d.curve
            for row in zip(d.curve.contact_radius, d.curve.depth, d.curve.force, strict=True)
        ]
        yield "", Table.of_rows(_HEADS, rows)
        yield "", self._chart(drawn, ordered=self.is_ordered(runs))
        summary = []
        for d in drawn:
            pull_off, zero_load, fixed_depth = d.points.values()
            ends = [(c.force, c.contact_radius, c.depth) for c in (pull_off, fixed_depth)]
            unloaded = zero_load.contact_radius, zero_load.depth
            summary.append(
                (d.name.key, self.work_of_adhesion, *ends[0], *unloaded, *ends[1], d.status)
            )
        yield "-summary", Table.of_rows(_SUMMARY_HEADS, summary)

    def _drawn(self, name: Label, run: Dataset) -> _Drawn:
        _refuse(run)
        path = run.isel(step=run["converged"].values & (run["contact_area"].values > 0))
        try:
            curve = curve_of(path, self.work_of_adhesion)
        except ConfigError as error:
            unknown = AdhesiveContact(*np.full(3, np.nan))
            return _Drawn(name, path, None, dict.fromkeys(_MARKERS, unknown), str(error))
        contacts = curve.instability(), curve.at_zero_load(), curve.instability(inf)
        points = dict(zip(_MARKERS, contacts, strict=True))
        return _Drawn(name, path, curve, points, _status(curve, points, path))

    def _chart(self, drawn: list[_Drawn], *, ordered: bool) -> Chart:
        series = list[Series]()
        for hue, d in enumerate(drawn):
            look, path = Look(hue, 1), (d.path["depth"].values, d.path["force"].values)
            series.append(Series(*path, look=look, role="reference"))
            if d.curve is None:
                continue
            end = d.points["last at fixed depth"].contact_radius
            # Without that point on the curve all of it is stable at a fixed depth.
            stable = ~(d.curve.contact_radius < end) & (np.gradient(d.curve.depth) >= 0)
            x, y = d.curve.depth, d.curve.force
            smooth = Look(hue, 0, hue if len(drawn) > 1 else None, sparse=True)
            series.append(Series(x[stable], y[stable], legend=d.name.words, look=smooth))
            series.append(Series(x[~stable], y[~stable], look=Look(hue, 3)))
            for mark, contact in d.points.items():
                at = np.array([contact.depth]), np.array([contact.force])
                series.append(Series(*at, look=Look(hue, None, _MARKERS[mark])))
        curves = [d.curve for d in drawn if d.curve is not None]
        grey = 0 if len(drawn) == 1 else None
        looks = {"with adhesion": Look(grey), "unstable at fixed depth": Look(grey, 3)}
        looks |= {mark: Look(grey, None, marker) for mark, marker in _MARKERS.items()}
        looks = (looks if curves else {}) | {"without adhesion": Look(grey, 1)}
        none = np.empty(0)
        series += [Series(none, none, legend=name, look=look) for name, look in looks.items()]
        depth, force = Axis("depth", "m"), Axis("force", "N", signed=True)
        strongest = -min((curve.force.min() for curve in curves), default=0.0)
        if strongest > 0:
            # Curves are shown up to a push as large as the strongest pull.
            depths = np.concatenate([curve.depth[curve.force <= strongest] for curve in curves])
            margin = 0.05 * np.ptp(depths)
            depth = replace(depth, limits=(depths.min() - margin, depths.max() + margin))
            force = replace(force, limits=(-1.1 * strongest, 1.1 * strongest))
        problems = dict.fromkeys(d.status for d in drawn if d.curve is None)
        note = "\n".join(textwrap.fill(problem, _LINE) for problem in problems)
        return Chart(depth, [force], series, self.title, note, hues=len(drawn), ordered=ordered)


def _status(curve: AxisymmetricCurve, points: dict[str, AdhesiveContact], path: Dataset) -> str:
    """Return which points are not on the path, not resolved, or steeper than the theory allows."""
    (low, high), grid = curve.contact_radius[[0, -1]], Result(path).grid
    last = path.isel(step=-1)
    profile = last["displacement"].values - last["depth"].item() - last["gap"].values
    path = path.isel(step=np.argsort(path["contact_radius"].values))
    slopes = [steepest(profile, contact, grid) for contact in path["contact"].values]
    missing, coarse, steep = list[str](), list[str](), list[str]()
    for mark, contact in points.items():
        radius = float(contact.contact_radius)
        slope = float(np.interp(radius, path["contact_radius"].values, slopes))
        if np.isnan(radius):
            missing.append(mark)
            continue
        if radius < FEW_CELLS * max(grid.spacing):
            coarse.append(f"{mark} {radius / max(grid.spacing):.1f}")
        if slope > _STEEP_RIM:
            steep.append(f"{mark} {slope:.2f}")
    range_ = f"not at a contact radius from {low:.3g} to {high:.3g} m, those of the path"
    remedy = f"from {FEW_CELLS} on force and radius are good to 2 %, so use more points"
    theory = f"the theory is for small slopes, below about {_STEEP_RIM}"
    problems = [
        f"{', '.join(missing)}: {range_}" * bool(missing),
        f"contact radius in cells: {', '.join(coarse)}; {remedy}" * bool(coarse),
        f"slope of the indenter at the rim: {', '.join(steep)}; {theory}" * bool(steep),
    ]
    return "; ".join(filter(None, problems)) or "computed"


def _refuse(run: Dataset) -> None:
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
