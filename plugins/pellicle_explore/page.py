"""The page of the explorer: sliders beside the pressure, the profile and the force curve."""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from importlib.resources import files
from typing import Any, Final

import tomli_w
from bokeh.document import Document
from bokeh.layouts import column
from bokeh.models.callbacks import CustomJS
from bokeh.models.widgets.buttons import Button
from bokeh.models.widgets.inputs import Checkbox
from bokeh.models.widgets.markups import Div, PreText
from bokeh.models.widgets.sliders import Slider

from pellicle.config.run import Run
from pellicle.errors import ConfigError, PellicleError

from .controls import Control, controls
from .documents import changed, document, letting_go, sticking
from .frames import Frame
from .markup import ERROR, REMARK, RESULT, lines, result
from .measured import Measured
from .plots import Plots
from .row import ControlRow
from .solving import Solving

_SAVE: Final = """
const link = document.createElement("a");
link.href = URL.createObjectURL(new Blob([text.text], {type: "application/toml"}));
link.download = "explored.toml";
link.click();
setTimeout(() => URL.revokeObjectURL(link.href), 1000);
"""
_LOG: Final = logging.getLogger(__name__)


def _template() -> Any:
    """Return the markup around the parts; bokeh takes text for it too, which its types do not."""
    return files("pellicle_explore").joinpath("page.html").read_text("utf-8")


class Explorer:
    """The content of one visitor's page and the run behind it."""

    def __init__(self, run: Run, measured: Measured | None, target: Document) -> None:
        self._run, self._target = run, target
        self._document: Mapping[str, Any] = document(run)
        self._solving = Solving(target, self._show)
        self._measured = measured
        self._share = measured.touch_share if measured else 0.0
        self._all_rows: dict[str, ControlRow] = {}
        self._rows: dict[str, ControlRow] = {}
        self._panel = column(sizing_mode="stretch_width")
        self._result, self._message, self._remarks = (
            Div(styles=styles, sizing_mode="stretch_width") for styles in (RESULT, ERROR, REMARK)
        )
        self._text = PreText(sizing_mode="stretch_width")
        self._plots = Plots(measured)

    def show(self) -> None:
        """Put the content on the page, and solve the run as it is."""
        self._target.title = "pellicle explore"
        self._target.template = _template()
        self._add_roots()
        self._list_controls()
        self._target.on_session_destroyed(lambda context: self._solving.close())
        self._solving.request(self._document)

    def _add_roots(self) -> None:
        """Add each part by itself, so that a new text does not lay out the plots again."""
        save = Button(label="Save the run file", button_type="primary", width=200)
        save.js_on_click(CustomJS(args={"text": self._text}, code=_SAVE))
        panel = column(self._panel, *self._other_controls(), save, sizing_mode="stretch_width")
        parts = {
            "result": self._result,
            "message": self._message,
            "remarks": self._remarks,
            "controls": panel,
            **self._plots.figures,
            "file": self._text,
        }
        for name, part in parts.items():
            part.name = name
            self._target.add_root(part)

    def _other_controls(self) -> list[Any]:
        """Return the controls beside those of quantities: adhesion, and the contact point."""
        sticks = Checkbox(label="the contact sticks", active=self._run.interaction is not None)
        sticks.on_change("active", self._stick)
        # Only steps in depth follow a contact that jumps.
        loading = self._run.loading
        sticks.visible = loading.prescribed == "depth" and not loading.samples
        if self._measured is None:
            return [sticks]
        shift = Slider(
            title="contact point of the measured curve, share of its range",
            start=0.0,
            end=1.0,
            step=0.002,
            value=self._share,
            sizing_mode="stretch_width",
        )
        shift.on_change("value", self._shift)
        return [sticks, shift]

    def _list_controls(self) -> None:
        """Show a row for each quantity of the present run.

        Rows are used again, since bokeh does not free parts that have left a page.
        """
        self._rows = {}
        for control in controls(Run.from_mapping(self._document)):
            if control.path not in self._all_rows:
                self._all_rows[control.path] = ControlRow(control, self._change)
            self._rows[control.path] = self._all_rows[control.path]
            self._rows[control.path].follow(control.value)
        self._panel.children = [part for entry in self._rows.values() for part in entry.parts]

    def _stick(self, attribute: str, old: bool, new: bool) -> None:
        if new == ("interaction" in self._document):
            return
        if new:
            self._document = sticking(self._document, self._likely_work())
        else:
            self._document = letting_go(self._document)
        self._list_controls()
        self._solving.request(self._document)

    def _likely_work(self) -> str:
        """Return a work of adhesion that makes a pull-off of some per cent of the largest force."""
        frame = self._solving.frame
        if frame is None or frame.force.max() <= 0:
            return "1 mJ/m^2"
        radius = math.sqrt(max(frame.contact_area, frame.cell_area))
        return f"{float(frame.force[frame.step]) / (60 * radius) * 1e3:.2g} mJ/m^2"

    def _shift(self, attribute: str, old: float, new: float) -> None:
        self._share = new
        if self._solving.frame is not None:
            self._plots.draw(self._solving.frame, self._share)

    def _change(self, control: Control, text: str) -> float | str:
        """Take a new value of a control; return it in SI, or the message of why it is refused."""
        try:
            self._document, value = changed(self._document, control, text)
        except ConfigError as error:
            return "; ".join(problem.message for problem in error.problems)
        self._solving.request(self._document)
        return value

    def _show(self, configuration: Mapping[str, Any], outcome: Frame | Exception) -> None:
        """Draw a frame, or show an error of the present run."""
        if configuration is self._document:
            self._show_error(outcome if isinstance(outcome, Exception) else None)
        if isinstance(outcome, Frame):
            self._plots.draw(outcome, self._share)
            self._result.text = result(outcome)
            self._text.text = tomli_w.dumps(configuration)
            if not outcome.is_preview:
                _fill(self._remarks, lines(outcome.remarks))

    def _show_error(self, error: Exception | None) -> None:
        """Show an error beside the controls that it names, or above the plots; None clears it."""
        beside: dict[str, str] = {}
        above: list[str] = []
        if isinstance(error, ConfigError):
            for problem in error.problems:
                if problem.field in self._rows:
                    beside[problem.field] = problem.message
                else:
                    above.append(str(problem))
        elif isinstance(error, PellicleError):
            above = [str(error)]
        elif error is not None:
            notes = getattr(error, "__notes__", ())
            above = ["; ".join([f"{type(error).__name__}: {error}", *notes])]
            _LOG.error("a component failed", exc_info=error)
        for path, entry in self._rows.items():
            entry.show_error(beside.get(path, ""))
        _fill(self._message, lines(above))


def _fill(part: Div, markup: str) -> None:
    """Show markup, or nothing in its place if it is empty."""
    part.text, part.visible = markup, bool(markup)
