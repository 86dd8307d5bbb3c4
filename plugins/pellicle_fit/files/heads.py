"""The heads of the columns of a file, and the roles that their words suggest."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from .columns import LABEL, UNITS, si_unit

_ROLES = {
    "time": "time",
    "force": "force|load|^f$",
    "deflection": "defl|bending",
    "position": "tip|separation|indent|depth",
    "height": r"height|piezo|ramp|sensor|snsr|exten|position|distance|displacement|(^|[\W_])z",
}
"""Words in names of columns, and the roles that they suggest; the first that fits counts."""
_BY_UNIT = {"N": "force", "V": "deflection", "s": "time"}
_OF_BASE = re.compile("height|piezo|ramp|sensor|snsr|exten")
"""Words for the place of a cantilever's base, also beside a force."""
_UNSAFE = re.compile(r'[,="$`\\]|^$')
"""What would have to be quoted on a command line."""


class Head(NamedTuple):
    """The head of a column, such as ``position [um]``, its name and its unit."""

    text: str
    name: str
    unit: str

    def is_called(self, name: str) -> bool:
        """Return whether a user who writes ``name`` may mean this column."""
        return plain(name).lower() in (self.text.lower(), self.name.lower())


def plain(text: str) -> str:
    """Return a text with one kind of µ and of space."""
    return " ".join(unicodedata.normalize("NFKC", text).replace("μ", "µ").split())


def guessed(
    heads: Sequence[Head],
    known: Mapping[str, tuple[str, str]],
) -> dict[str, tuple[str, str]]:
    """Return names of columns and their units, empty if not known, by the roles they may have.

    Those that are ``known`` come first.
    """
    columns = [(role, name, Head("", name, unit)) for role, (name, unit) in known.items()]
    for index, head in enumerate(heads):
        names = (t for t in (head.name, head.text) if sum(h.is_called(t) for h in heads) == 1)
        name = next((text for text in names if not _UNSAFE.search(text)), str(index + 1))
        words = (role for role, of in _ROLES.items() if re.search(of, head.name.lower()))
        columns.append((next(words, _BY_UNIT.get(si_unit(head.unit), "")), name, head))
    found: dict[str, tuple[str, str, str]] = {}
    for role, name, head in columns:
        is_signal = role in ("force", "deflection")
        kind = "signal" if is_signal else role if role in ("", "time", LABEL) else "place"
        allowed = "mNV" if is_signal else UNITS.get(role, "m")
        units = [head.unit, *reversed(re.split(r"[\W_]+", head.name))]
        unit = next((u for u in units if si_unit(u) in [*allowed]), "")
        if unit and is_signal:
            # Instruments call a signal in any unit a deflection.
            role = "force" if si_unit(unit) == "N" else "deflection"
        if kind and (unit or kind != "time" or role in known):
            found.setdefault(kind, (role, name, unit))
    signal, name, _ = found.setdefault("signal", ("deflection", "<column>", ""))
    role, place, unit = found.setdefault("place", ("height", "<column>", ""))
    if role == "height" and role not in known and "<" not in place + name:
        # Most heights fall as the tip goes down, and most others grow; which it is shows in a fit.
        if signal == "force" and not _OF_BASE.search(place.lower()):
            role = "position"
        elif "height" not in place.lower():
            role = "extension"
        found["place"] = (role, place, unit)
    return {role: (name, unit) for role, name, unit in found.values()}
