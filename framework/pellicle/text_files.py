"""Text files of strangers, in whatever encoding an editor or an instrument wrote them."""

from __future__ import annotations

import codecs
from pathlib import Path

# The longer marks first: that of UTF-32 begins with that of UTF-16.
_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}


def read_text(path: Path) -> str:
    """Return a text in UTF-8, in UTF-16 or UTF-32 with their mark, or in Windows' code page 1252.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        It is not text.
    """
    content = path.read_bytes()
    encoding = next((_MARKS[mark] for mark in _MARKS if content.startswith(mark)), None)
    try:
        text = content.decode(encoding or "utf-8")
    except UnicodeDecodeError:
        if encoding is not None:
            raise
        # Instruments write µ, ° and ² so, and any other file of one byte a letter passes as this.
        text = content.decode("cp1252")
    if "\0" in text:
        raise ValueError("it holds bytes that are not text")
    return text
