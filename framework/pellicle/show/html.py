"""A self-contained web page of text, tables, pictures, and maps that can be zoomed.

Every text is shown literally, markup included. The page loads nothing: style, script, pictures and
the values of the maps are in it, and it forbids the browser to fetch anything else.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from itertools import zip_longest
from typing import Any

from pellicle.components.charts import Column, Table
from pellicle.files import for_document

from .maps import Maps
from .numbers import is_number

_LONG = 30
"""Letters of the longest cell of a column that stays on one line."""
_HASH = re.compile(r"\b([0-9a-f]{8})[0-9a-f]{24,}\b")


@dataclass(frozen=True)
class Text:
    """A paragraph."""

    text: str
    lead: bool = False
    """Whether it stands out as the result."""


@dataclass(frozen=True)
class Notice:
    """A sentence that stands out."""

    text: str
    good: bool | None
    """Whether all is well; None if it is, with reservations."""
    details: Sequence[str] = ()
    """Lines below it."""


@dataclass(frozen=True)
class Picture:
    """A static drawing."""

    svg: bytes
    caption: str
    description: str
    """Text for readers who cannot see the drawing."""
    marks: Sequence[Sequence[tuple[float, float]]] = ()
    """Points for each frame of the page's first maps, as shares of width and height from top left;
    those of the frame that is shown are marked."""
    wide: bool = False
    """Whether it has the whole width of the page."""
    by_frame: Sequence[Picture] = ()
    """Pictures that take its place while a frame of the page's first maps is shown, one for each;
    it may be one picture for several frames."""

    @property
    def alternatives(self) -> dict[str, Any]:
        """The distinct pictures of `by_frame`, and the number of that for each frame."""
        distinct = list({id(picture): picture for picture in self.by_frame}.values())
        numbers = {id(picture): number for number, picture in enumerate(distinct)}
        return {
            "pictures": [
                {"source": p.source, "caption": p.caption, "description": p.description}
                for p in distinct
            ],
            "frames": [numbers[id(picture)] for picture in self.by_frame],
        }

    @property
    def source(self) -> str:
        """The drawing as a ``data:`` address, which keeps its ids apart from those of the page."""
        return f"data:image/svg+xml;base64,{base64.b64encode(self.svg).decode()}"


@dataclass(frozen=True)
class Code:
    """Text to be typed or saved literally."""

    text: str
    caption: str = ""
    file: str = ""
    """Name under which a click saves it."""

    @property
    def source(self) -> str:
        """The text as a ``data:`` address."""
        return (
            f"data:text/plain;charset=utf-8;base64,{base64.b64encode(self.text.encode()).decode()}"
        )


Block = Text | Notice | Table | Picture | Code | Maps


@dataclass(frozen=True)
class Section:
    """A heading and the blocks below it."""

    title: str
    blocks: Sequence[Block]


def page(title: str, sections: Sequence[Section], subtitle: str = "") -> str:
    """Return a page as HTML.

    Parameters
    ----------
    title, subtitle
        Heading, and the line below it.
    sections
        In order; a section without blocks is left out.
    """
    html: str = _template().render(
        title=title,
        subtitle=subtitle,
        sections=[section for section in sections if section.blocks],
        style=_part("page.css"),
        script=_part("page.js"),
    )
    return html


def _column(column: Column) -> dict[str, Any]:
    """Return the head and the cells of a column of a table; hashes are shortened."""
    label, texts = column.read()
    shown = [_HASH.sub(r"\1…", text) for text in texts]
    cells = [
        {"text": short, "whole": text if short != text else "", "bad": bad, "frame": frame}
        for short, text, bad, frame in zip_longest(shown, texts, column.bad, column.frames)
    ]
    words = "" if all(map(is_number, texts)) else "words"
    if max(map(len, shown), default=0) > _LONG:
        words = "long words"
    return {"column": column, "label": label, "words": words, "cells": cells}


def _part(name: str) -> str:
    return files("pellicle.show").joinpath(name).read_text(encoding="utf-8")


@cache
def _template() -> Any:
    from jinja2 import Environment, StrictUndefined

    environment = Environment(
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=lambda value: for_document(value) if type(value) is str else value,
    )
    environment.filters["kind"] = lambda block: type(block).__name__
    environment.filters["shown"] = lambda table: list(map(_column, table.columns))
    return environment.from_string(_part("page.html"))
