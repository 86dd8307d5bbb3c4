"""Text of the page: escaped, and in the style of a result, an error or a remark."""

from __future__ import annotations

import html
import math
from collections.abc import Iterable

from pellicle.units import readable

from .frames import Frame

ERROR: dict[str, str | None] = {"color": "#b00020"}
"""Style of errors."""
RESULT: dict[str, str | None] = {"font-size": "1.1rem"}
"""Style of the numbers of a run."""
REMARK: dict[str, str | None] = {"color": "#6b4e00"}
"""Style of the warnings of a run."""


def escaped(text: str) -> str:
    """Return a text as markup that shows it."""
    return html.escape(text)


def lines(texts: Iterable[str]) -> str:
    """Return texts as markup, one below the other."""
    return "<br>".join(map(escaped, texts))


def result(frame: Frame) -> str:
    """Return the numbers of a run at its largest force as markup."""
    force, radius = float(frame.force[frame.step]), math.sqrt(frame.contact_area / math.pi)
    sign = "≈ " if frame.is_preview else ""
    words = (
        f"At a depth of {readable(float(frame.depth[frame.step]), 'm', 4)}: "
        f"force {sign}<b>{readable(force, 'N', 4)}</b>, "
        f"contact radius {sign}{readable(radius, 'm', 3)} (of a circle of that area)"
    )
    lowest = float(frame.force.min())
    return f"{words}; lowest force {readable(lowest, 'N', 4)}" if lowest < 0 else words
