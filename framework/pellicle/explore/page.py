"""The page of the explorer: sliders beside the pressure, the profile and the force curve."""

from __future__ import annotations

import math
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import tomli_w
from bokeh.document import Document
from bokeh.layouts import column, row
from bokeh.models.annotations.legends import Legend, LegendItem
from bokeh.models.callbacks import CustomJS
from bokeh.models.sources import ColumnDataSource
from bokeh.models.widgets.buttons import Button
from bokeh.models.widgets.inputs import Checkbox, TextInput
from bokeh.models.widgets.markups import Div, PreText
from bokeh.models.widgets.sliders import Slider
from bokeh.plotting import figure

from pellicle.arrays import Array
from pellicle.config.run import Run
from pellicle.errors import ConfigError, PellicleError
from pellicle.report.style import OKABE_ITO
from pellicle.units import axis_unit, readable

from .controls import Control, changed, controls, document, letting_go, sticking
from .frames import Frame, solved

_BLUE, _ORANGE, _GREY = *OKABE_ITO[:2], "#767676"
_STEP = 0.01
"""Step of a slider in decades."""
_SAVE = """
const link = document.createElement("a");
link.href = URL.createObjectURL(new Blob([text.text], {type: "application/toml"}));
link.download = "explored.toml";
link.click();
setTimeout(() => URL.revokeObjectURL(link.href), 1000);
"""
_ERROR: dict[str, str | None] = {"color": "#b00020"}
_ANSWER: dict[str, str | None] = {"font-size": "1.1rem"}


class Measured(NamedTuple):
    """A measured force curve."""

    position: Array
    """Position that grows into the solid [m], shape (n,)."""
    force: Array
    """Force [N], shape (n,)."""

    @property
    def touch(self) -> float:
        """The position at which the force reaches 5 % of its range [m]."""
        low, high = float(self.force.min()), float(self.force.max())
        above = self.force > low + 0.05 * (high - low)
        return float(self.position[int(np.argmax(above))])


class Explorer:
    """The content of one visitor's page and the run behind it."""

    def __init__(self, run: Run, measured: Measured | None, target: Document) -> None:
        self._run, self._target = run, target
        self._document: Mapping[str, Any] = document(run)
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="explorer")
        self._is_stale = self._is_working = False
        self._measured = measured
        self._point = measured.touch if measured else 0.0
        self._rows: dict[str, _Row] = {}
        self._panel = column(sizing_mode="stretch_width")
        self._frame: Frame | None = None
        self._answer = Div(styles=_ANSWER, sizing_mode="stretch_width")
        self._message = Div(styles=_ERROR, sizing_mode="stretch_width")
        self._text = PreText(sizing_mode="stretch_width")
        self._cut = ColumnDataSource({"x": [], "surface": [], "indenter": [], "pressure": []})
        self._path = ColumnDataSource({"depth": [], "force": []})
        self._curve = ColumnDataSource({"depth": [], "force": []})
        self._plots = _plots(self._cut, self._path, self._curve if measured else None)

    def show(self) -> None:
        """Put the content on the page, and solve the run as it is."""
        self._target.title = "pellicle explore"
        self._target.add_root(self._layout())
        self._list_controls()
        self._target.on_session_destroyed(lambda context: self._worker.shutdown(wait=False))
        self._request()

    def _layout(self) -> Any:
        save = Button(label="Save the run file", button_type="primary", width=200)
        save.js_on_click(CustomJS(args={"text": self._text}, code=_SAVE))
        sticks = Checkbox(label="the contact sticks", active=self._run.interaction is not None)
        sticks.on_change("active", self._stick)
        # Only steps in depth follow a contact that jumps.
        loading = self._run.loading
        sticks.visible = loading.prescribed == "depth" and not loading.samples
        panel = [self._panel, sticks]
        if self._measured is not None:
            span = float(np.ptp(self._measured.position))
            shift = Slider(
                title="contact point of the measured curve, share of its range",
                start=0.0,
                end=1.0,
                step=0.002,
                value=(self._point - float(self._measured.position.min())) / span,
                sizing_mode="stretch_width",
            )
            shift.on_change("value", self._shift)
            panel.append(shift)
        fixed = {"flex": "1 1 280px", "max-width": "420px"}
        wide = {"flex": "3 1 300px", "min-width": "280px"}
        wrap = {"display": "flex", "flex-wrap": "wrap", "width": "100%"}
        return column(
            self._answer,
            self._message,
            row(
                column(*panel, save, styles=fixed),
                column(*self._plots, styles=wide),
                column(Div(text="<b>Run file</b>"), self._text, styles=fixed),
                styles=wrap,
                sizing_mode="stretch_width",
            ),
            sizing_mode="stretch_width",
        )

    def _list_controls(self) -> None:
        """Show a row for each quantity of the present run."""
        listed = controls(Run.from_mapping(self._document))
        self._rows = {control.path: _Row(control, self._change) for control in listed}
        self._panel.children = [part for entry in self._rows.values() for part in entry.parts]

    def _stick(self, attribute: str, old: bool, new: bool) -> None:
        if new == ("interaction" in self._document):
            return
        if new:
            self._document = sticking(self._document, self._likely_work())
        else:
            self._document = letting_go(self._document)
        self._list_controls()
        self._request()

    def _likely_work(self) -> str:
        """Return a work of adhesion that makes a pull-off of some per cent of the largest force."""
        if self._frame is None:
            return "1 mJ/m^2"
        last = self._frame.steps.isel(step=self._frame.step)
        radius = math.sqrt(max(float(last["contact_area"]), float(np.prod(self._frame.spacing))))
        return f"{float(last['force']) / (60 * radius) * 1e3:.2g} mJ/m^2"

    def _shift(self, attribute: str, old: float, new: float) -> None:
        assert self._measured is not None
        position = self._measured.position
        self._point = float(position.min()) + new * float(np.ptp(position))
        self._request()

    def _change(self, control: Control, text: str) -> None:
        """Take a new value of a control, or say beside it why not."""
        entry = self._rows[control.path]
        try:
            self._document = changed(self._document, control, text)
        except ConfigError as error:
            entry.refuse("; ".join(problem.message for problem in error.problems))
            return
        entry.refuse("")
        self._request()

    def _request(self) -> None:
        """Solve the present run, once the one that is being solved is finished."""
        self._is_stale = True
        if not self._is_working:
            self._is_working, self._is_stale = True, False
            self._worker.submit(self._solve, self._document)

    def _solve(self, configuration: Mapping[str, Any]) -> None:
        outcome: Frame | PellicleError
        try:
            outcome = solved(configuration)
        except PellicleError as error:
            outcome = error
        self._target.add_next_tick_callback(partial(self._show, configuration, outcome))

    def _show(self, configuration: Mapping[str, Any], outcome: Frame | PellicleError) -> None:
        self._is_working = False
        for entry in self._rows.values():
            entry.refuse("")
        if isinstance(outcome, PellicleError):
            self._blame(outcome)
        else:
            self._draw(outcome)
            self._message.text = ""
            self._text.text = tomli_w.dumps(configuration)
        if self._is_stale:
            self._request()

    def _blame(self, error: PellicleError) -> None:
        problems = error.problems if isinstance(error, ConfigError) else ()
        others = []
        for problem in problems:
            if problem.field in self._rows:
                self._rows[problem.field].refuse(problem.message)
            else:
                others.append(str(problem))
        if not problems:
            others = [str(error)]
        self._message.text = "<br>".join(map(_escaped, others))

    def _draw(self, frame: Frame) -> None:
        self._frame = frame
        steps = frame.steps
        depth, force = steps["depth"].values, steps["force"].values
        heights = np.append(frame.surface, frame.indenter[np.isfinite(frame.indenter)])
        (lx, ux), (lz, uz) = axis_unit(frame.x, "m"), axis_unit(heights, "m")
        lp, up = axis_unit(frame.pressure, "Pa")
        (ld, ud), (lf, uf) = axis_unit(depth, "m"), axis_unit(force, "N")
        self._cut.data = {
            "x": frame.x * lx,
            "surface": frame.surface * lz,
            "indenter": frame.indenter * lz,
            "pressure": frame.pressure * lp,
        }
        self._path.data = {"depth": depth * ld, "force": force * lf}
        profile, pressure, path = self._plots
        for plot, across, up_ in ((profile, ux, uz), (pressure, ux, up), (path, ud, uf)):
            plot.xaxis.axis_label = f"{'depth' if plot is path else 'x'} [{across}]"
            name = {id(profile): "height", id(pressure): "pressure"}.get(id(plot), "force")
            plot.yaxis.axis_label = f"{name} [{up_}]"
        if self._measured is not None:
            position = self._measured.position - self._point
            self._curve.data = {"depth": position * ld, "force": self._measured.force * lf}
        self._answer.text = _answer(frame)


class _Row:
    """A control on the page: a field, a slider, and room for what is wrong."""

    def __init__(self, control: Control, change: Any) -> None:
        self._control, self._change = control, change
        self._is_following = False
        self._field = TextInput(
            title=control.label,
            value=readable(control.value, control.quantity.unit, 4),
            sizing_mode="stretch_width",
        )
        self._slider = self._made_slider()
        self._error = Div(styles=_ERROR, sizing_mode="stretch_width", visible=False)
        self._field.on_change("value", self._typed)
        self._slider.on_change("value", self._moved)
        self.parts = (self._field, self._slider, self._error)

    def _made_slider(self) -> Slider:
        control = self._control
        start, value, end, step = control.low, control.value, control.high, control.high / 100
        if control.is_logarithmic:
            start, value, end = map(math.log10, (start, value, end))
            step = _STEP
        return Slider(
            start=start,
            end=end,
            step=step,
            value=value,
            title=None,
            show_value=False,
            sizing_mode="stretch_width",
        )

    def refuse(self, message: str) -> None:
        """Show why the value is not allowed; nothing if it is."""
        self._error.text = _escaped(message)
        self._error.visible = bool(message)

    def _moved(self, attribute: str, old: float, new: float) -> None:
        if self._is_following:
            return
        value = 10**new if self._control.is_logarithmic else new
        self._is_following = True
        self._field.value = self._control.text(value)
        self._is_following = False
        self._change(self._control, self._field.value)

    def _typed(self, attribute: str, old: str, new: str) -> None:
        if not self._is_following:
            self._change(self._control, new)


def _plots(
    cut: ColumnDataSource, path: ColumnDataSource, curve: ColumnDataSource | None
) -> tuple[Any, Any, Any]:
    """Return the figures of profile, pressure and force curve."""
    profile, pressure, force = (
        figure(height=height, sizing_mode="stretch_width", tools="pan,wheel_zoom,reset,save")
        for height in (240, 200, 260)
    )
    surface = profile.line("x", "surface", source=cut, color=_BLUE, line_width=2)
    indenter = profile.line("x", "indenter", source=cut, color=_GREY, line_dash="dashed")
    _name_lines(profile, {"surface": surface, "indenter": indenter})
    pressure.line("x", "pressure", source=cut, color=_BLUE, line_width=2)
    computed = force.line("depth", "force", source=path, color=_BLUE, line_width=2)
    force.scatter("depth", "force", source=path, color=_BLUE, size=6)
    if curve is not None:
        measured = force.line(
            "depth", "force", source=curve, color=_ORANGE, line_width=2, line_dash="dotted"
        )
        _name_lines(force, {"computed": computed, "measured": measured})
    for plot in (profile, pressure, force):
        plot.toolbar.logo = None
        plot.toolbar_location = "right"
    return profile, pressure, force


def _name_lines(plot: Any, lines: Mapping[str, Any]) -> None:
    """Put the names of lines above a plot, where they cover none."""
    items = [LegendItem(label=name, renderers=[line]) for name, line in lines.items()]
    plot.add_layout(Legend(items=items, orientation="horizontal", border_line_alpha=0.0), "above")


def _answer(frame: Frame) -> str:
    last = frame.steps.isel(step=frame.step)
    area = float(last["contact_area"])
    words = [
        f"At a depth of {readable(float(last['depth']), 'm', 4)}: "
        f"force <b>{readable(float(last['force']), 'N', 4)}</b>, "
        f"contact radius {readable(math.sqrt(area / math.pi), 'm', 3)} (of a circle of that area)"
    ]
    lowest = float(frame.steps["force"].min())
    if lowest < 0:
        words[0] += f"; lowest force {readable(lowest, 'N', 4)}"
    statuses = dict.fromkeys(str(status) for status in frame.steps["status"].values)
    remarks = [text for text in statuses if text != "converged"] + list(frame.warnings)
    words += [f'<span style="color: #6b4e00">{_escaped(text)}</span>' for text in remarks]
    return "<br>".join(words)


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
