"""A control on the page."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from bokeh.models.widgets.inputs import TextInput
from bokeh.models.widgets.markups import Div
from bokeh.models.widgets.sliders import Slider

from pellicle.units import readable

from .controls import Control
from .markup import ERROR, escaped

# Step of a slider in decades.
_STEP = 0.01


class ControlRow:
    """A field, a slider, and room for what is wrong with the value.

    Parameters
    ----------
    control
        The quantity.
    change
        Called with the control and the text of each new value; returns the value in SI, or the
        message of why it is not allowed.
    """

    def __init__(self, control: Control, change: Callable[[Control, str], float | str]) -> None:
        self._control, self._change = control, change
        self._is_following = self._is_refused = False
        self._value = control.value
        self._field = TextInput(
            title=control.label,
            value=readable(control.value, control.quantity.unit, 4),
            sizing_mode="stretch_width",
        )
        self._slider = self._new_slider()
        self._error = Div(styles=ERROR, sizing_mode="stretch_width", visible=False)
        self._field.on_change("value", self._typed)
        self._slider.on_change("value", self._moved)
        self.parts = (self._field, self._slider, self._error)

    def follow(self, value: float) -> None:
        """Show a value in SI that was set, or left as it is, elsewhere than in this row."""
        if self._is_refused or value != self._value:
            self._is_refused, self._value = False, value
            with self._following():
                self._field.value = readable(value, self._control.quantity.unit, 4)
            self._move(value)
        self._show("")

    def show_error(self, message: str) -> None:
        """Show why the run is not possible with this value; nothing if it is.

        A text that is not a value at all stays refused until it is replaced.
        """
        if not self._is_refused:
            self._show(message)

    def _new_slider(self) -> Slider:
        control = self._control
        return Slider(
            start=self._position(control.low),
            end=self._position(control.high),
            step=_STEP if control.is_logarithmic else control.high / 100,
            value=self._position(control.value),
            title=None,
            show_value=False,
            sizing_mode="stretch_width",
        )

    def _position(self, value: float) -> float:
        """Return the position of the slider for a value."""
        return math.log10(value) if self._control.is_logarithmic else value

    def _moved(self, attribute: str, old: float, new: float) -> None:
        if self._is_following:
            return
        text = self._control.text(10**new if self._control.is_logarithmic else new)
        with self._following():
            self._field.value = text
        self._take(text)

    def _typed(self, attribute: str, old: str, new: str) -> None:
        if self._is_following:
            return
        if self._take(new):
            self._move(self._value)

    def _move(self, value: float) -> None:
        """Move the slider to a value, or to its end on that side."""
        low, high = self._control.low, self._control.high
        with self._following():
            self._slider.value = self._position(min(max(value, low), high))

    @contextmanager
    def _following(self) -> Iterator[None]:
        """Let field or slider follow the other without a second change."""
        self._is_following = True
        try:
            yield
        finally:
            self._is_following = False

    def _take(self, text: str) -> bool:
        """Pass on a text; return whether it is a value."""
        value = self._change(self._control, text)
        self._is_refused = isinstance(value, str)
        if not isinstance(value, str):
            self._value = value
        self._show(value if isinstance(value, str) else "")
        return not self._is_refused

    def _show(self, message: str) -> None:
        self._error.text = escaped(message)
        self._error.visible = bool(message)
