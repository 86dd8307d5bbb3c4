"""Texts of strangers: files in any encoding, and characters that no document may hold."""

from __future__ import annotations

import codecs
import re
from pathlib import Path

# The longer marks first: that of UTF-32 begins with that of UTF-16.
_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}


# Neither XML nor HTML allows them; line feeds and tabs it does.
_NOT_IN_DOCUMENTS = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


def for_document(text: str) -> str:
    """Return a text with a replacement character for each that no document may hold."""
    return _NOT_IN_DOCUMENTS.sub("\ufffd", text)


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
