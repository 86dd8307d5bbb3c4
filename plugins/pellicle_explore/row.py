"""A control on the page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from bokeh.models.widgets import Div, Slider, TextInput

from pellicle.units import readable

from .controls import Control

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
