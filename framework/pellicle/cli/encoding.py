"""Replace characters that a terminal or a file cannot encode by similar ASCII."""

from __future__ import annotations

import codecs
import io
import unicodedata
from typing import TextIO

_HANDLER = "pellicle.readable"
_SIGNS = (
    {"µ": "u", "×": "x", "·": "*", "⋅": "*", "−": "-", "–": "-", "—": "-", "…": "..."}
    | {"≤": "<=", "≥": ">=", "≠": "!=", "≈": "~", "∞": "inf", "√": "sqrt", "∂": "d", "⁄": "/"}
    | {"‘": "'", "’": "'", "“": '"', "”": '"', "°": " deg", "─": "-", "━": "-", "│": "|"}
)


def encode_readably(stream: TextIO) -> None:
    """Let a stream replace characters that its encoding lacks: µ by u, τ by tau, ≤ by <=.

    Windows writes redirected output in a code page of 256 characters.
    """
    if isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(errors=_HANDLER)


def as_printed(text: str, stream: TextIO) -> str:
    """Return a text as a stream prints it, which may make it longer: "µ" or "um", "…" or "..."."""
    encoding = getattr(stream, "encoding", None)
    if encoding is None:
        return text
    return text.encode(encoding, _HANDLER).decode(encoding).replace("[ deg", "[deg")


def _replace(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(map(_ascii, error.object[error.start : error.end])), error.end


def _ascii(character: str) -> str:
    """Return ASCII similar to a character, or a question mark."""
    if character in _SIGNS:
        return _SIGNS[character]
    name = unicodedata.name(character, "")
    if name.startswith("GREEK "):
        # "GREEK SMALL LETTER TAU", "GREEK CAPITAL LETTER DELTA WITH TONOS"
        letter = name.partition(" LETTER ")[2].partition(" ")[0]
        return letter.capitalize() if "CAPITAL" in name else letter.lower()
    plain = unicodedata.normalize("NFKD", character)
    power = "^" if name.startswith("SUPERSCRIPT ") else ""
    letters = [_SIGNS.get(part, part) for part in plain if not unicodedata.combining(part)]
    text = f"{power}{''.join(letters)}"
    return text if text.isascii() else "?"


codecs.register_error(_HANDLER, _replace)
