"""Run documents as the explorer changes them: mappings of the form of a run file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pellicle.config.run import Run
from pellicle.errors import ConfigError
from pellicle.model.paths import replaced

from .controls import Control


def changed(
    document: Mapping[str, Any], control: Control, text: str
) -> tuple[dict[str, Any], float]:
    """Return a run document with a new value of a control, given as text, and the value in SI.

    All load steps change in proportion to their largest.

    Raises
    ------
    ConfigError
        The text is not an allowed value; the error names the path of the control.
    """
    try:
        value: Any = float(text)
    except ValueError:
        value = text
    try:
        number = control.quantity(value)
    except ValueError as error:
        raise ConfigError(str(error), control.path) from None
    if control.path.startswith("loading."):
        if number <= 0:
            message = (
                f"{text!r} is not above 0; the load steps keep their proportion to the largest"
            )
            raise ConfigError(message, control.path)
        key = control.path.partition(".")[2]
        steps = document["loading"][key]
        factor = number / max(map(abs, steps))
        return dict(replaced(document, control.path, [step * factor for step in steps])), number
    return dict(replaced(document, control.path, value)), number


def document(run: Run) -> dict[str, Any]:
    """Return a run as a document in SI that makes an equal one, with its load steps as a list."""
    data: dict[str, Any] = run.model_dump(mode="json", exclude_unset=True, exclude_none=True)
    if not run.loading.samples:
        key = f"loading.{run.loading.prescribed}"
        data = dict(replaced(data, key, list(run.loading.values)))
    return data


def sticking(data: Mapping[str, Any], work_of_adhesion: str) -> dict[str, Any]:
    """Return a run document with a contact that sticks, pulled off after it is pressed in.

    The load steps go back to half the largest depth above the surface.
    """
    key = Run.from_mapping(data).loading.prescribed
    steps = data["loading"][key]
    back = [0.0, -steps[-1] / 4, -steps[-1] / 2]
    path = [*steps, *reversed(steps[:-1]), *back]
    loaded = dict(replaced(data, f"loading.{key}", path))
    return loaded | {"interaction": {"type": "jkr", "work_of_adhesion": work_of_adhesion}}


def letting_go(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return a run document without an interaction, and with the steps up to the deepest."""
    key = Run.from_mapping(data).loading.prescribed
    steps = data["loading"][key]
    loaded = dict(replaced(data, f"loading.{key}", steps[: steps.index(max(steps)) + 1]))
    return {name: table for name, table in loaded.items() if name != "interaction"}
