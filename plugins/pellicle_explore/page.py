"""The page of the explorer: sliders beside the pressure, the profile and the force curve."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

import tomli_w
from bokeh.document import Document
from bokeh.layouts import column
from bokeh.models.widgets import Div, PreText, Slider, TextInput

import pellicle as pl
from pellicle.errors import PellicleError
from pellicle.units import readable

from .controls import Control, change_control, configuration_of, controls
from .plots import Plots
from .solving import Frame, Solving

_POSITIONS: Final = 200
_DIGITS: Final = 4
"""Significant digits of a value that a slider sets."""


class ControlRow:
    """A field, a slider, and room for why ``change`` refuses a text of the field."""

    def __init__(self, control: Control, change: Callable[[Control, str], float]) -> None:
        self._control, self._change = control, change
        self._position = control.position(control.value)
        start, end = control.position(0.0), control.position(float("inf"))
        self._slider = Slider(
            start=start,
            end=end,
            step=(end - start) / _POSITIONS,
            value=self._position,
            title=None,
            show_value=False,
        )
        text = readable(control.value, control.quantity.unit, _DIGITS)
        self._field = TextInput(title=control.label, value=text)
        self._refusal = Div(render_as_text=True, styles={"color": "#b00020"}, visible=False)
        self._field.on_change("value", self._take)
        self._slider.on_change("value", self._move)
        self.parts = (self._field, self._slider, self._refusal)
        for part in self.parts:
            part.sizing_mode = "stretch_width"

    def _move(self, attribute: str, old: float, new: float) -> None:
        """Put the value of the slider into the field, unless the slider follows the field."""
        if new != self._position:
            self._position, value = new, self._control.value_at(new)
            self._field.value = readable(value, self._control.quantity.unit, _DIGITS)

    def _take(self, attribute: str, old: str, new: str) -> None:
        """Pass on a text; the slider follows it, or a message says why it is refused."""
        message = ""
        try:
            position = self._control.position(self._change(self._control, new))
        except ValueError as error:
            message = str(error).removeprefix(f"{self._control.path}: ")
        else:
            # A slider that is dragged would fight against a position that is only rounded.
            if abs(position - self._position) > self._slider.step / 2:
                self._position = self._slider.value = position
        self._refusal.text, self._refusal.visible = message, bool(message)


class Explorer:
    """The content of one visitor's page, and the run behind it, which is solved as it is."""

    def __init__(self, run: pl.Run, target: Document) -> None:
        self._configuration: Mapping[str, Any] = configuration_of(run)
        self._solving = Solving(target, self._show)
        self._plots = Plots()
        self._rows = {of.path: ControlRow(of, self._change) for of in controls(run)}
        self._result = Div(sizing_mode="stretch_width")
        self._message = Div(render_as_text=True, sizing_mode="stretch_width")
        self._remarks = Div(render_as_text=True, sizing_mode="stretch_width")
        self._file = PreText(sizing_mode="stretch_width")
        target.title = "pellicle explore"
        # Bokeh takes text for a template too, which its types do not.
        template: Any = Path(__file__).with_name("page.html").read_text("utf-8")
        target.template = template
        of_run: list[Any] = [part for row in self._rows.values() for part in row.parts]
        parts = {
            "result": self._result,
            "message": self._message,
            "remarks": self._remarks,
            "controls": column(*of_run, sizing_mode="stretch_width"),
            "profile": self._plots.profile,
            "pressure": self._plots.pressure,
            "force": self._plots.force,
            "file": self._file,
        }
        # Each part is a root, so that a new text does not lay out the plots again.
        for name, part in parts.items():
            part.name = name
            target.add_root(part)
        self._solving.request(self._configuration)

    def _change(self, control: Control, text: str) -> float:
        """Take a new value of a control; return it in SI, or raise a ValueError."""
        self._configuration, value = change_control(self._configuration, control, text)
        self._solving.request(self._configuration)
        return value

    def _show(self, solved: Mapping[str, Any], outcome: Frame | Exception) -> None:
        """Draw the frame of a configuration, or show the error of the present one."""
        if solved is self._configuration:
            self._message.text = _error_text(outcome) if isinstance(outcome, Exception) else ""
            self._message.visible = isinstance(outcome, Exception)
        if isinstance(outcome, Frame):
            self._plots.draw(outcome)
            self._result.text = outcome.summary()
            self._remarks.text = "\n".join(outcome.remarks)
            self._remarks.visible = bool(outcome.remarks)
            self._file.text = tomli_w.dumps(solved)


def _error_text(error: Exception) -> str:
    """Return the message of an error; one of a component is logged with its traceback."""
    if isinstance(error, PellicleError):
        return str(error)
    logging.getLogger(__name__).error("a component failed", exc_info=error)
    return "; ".join([f"{type(error).__name__}: {error}", *getattr(error, "__notes__", ())])
