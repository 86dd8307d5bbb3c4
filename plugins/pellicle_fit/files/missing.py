"""What a file does not say of its curves, and the options to type that say it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence

from pellicle.errors import ConfigError, excerpt

from .columns import NAMES, UNITS, Calibration, Column, Columns, missing_parts, plain, si_unit

OPTIONS = {
    "spring_constant": '--spring-constant "… N/m"',
    "sensitivity": '--sensitivity "… nm/V"',
    "sensitivity if it is in volts": '--sensitivity "… nm/V"',
    "sensitivity [nm/nA]": '--sensitivity "… nm/nA"',
    "radius": '--radius "… um"',
    "half_angle": '--half-angle "… degree"',
}
"""How what only the user knows is typed."""
UNKNOWN = "<column>"
"""What stands for a column that none may be."""
SHOWN = 12
"""Largest number of columns that a message names."""
_ROLES = {
    "time": "time|zeit|temps|tempo|tiempo",
    "force": "force|load|kraft|forza|fuerza|^f$",
    "deflection": "defl|bending",
    "position": "tip|separation|indent|depth",
    "height": r"height|piezo|ramp|sensor|snsr|exten|position|distance|displacement|(^|[\W_])z",
}
"""Words in names of columns, and the roles that they suggest; the first that fits counts."""
_BY_UNIT = {"N": "force", "V": "deflection", "A": "deflection", "s": "time"}
_OF_BASE = re.compile("height|piezo|ramp|sensor|snsr|exten")
"""Words for the place of a cantilever's base, also beside a force."""
_IN_SECONDS = re.compile(r"[\W_](m|u|µ)?s(ec)?$")
"""A name that ends with a unit of time."""
_UNSAFE = re.compile(r'[,="$`\\]|^$')
"""What would have to be quoted on a command line."""


class MissingInputError(ConfigError):
    """A file lacks what only its user knows: ``options``, by what is missing, say it with a …."""

    def __init__(self, where: str, options: Mapping[str, str]) -> None:
        self.where, self.options = where, options
        typed = " ".join(filter(None, dict.fromkeys(options.values())))
        super().__init__(
            f"{where}missing: {', '.join(options)}"
            + (f"; add, with your values for … and <…>:\n  {typed}" if typed else "")
        )


def missing_in(
    where: str,
    heads: Sequence[Column],
    wrong: Sequence[str],
    columns: Columns,
    calibration: Calibration,
) -> MissingInputError:
    """Return the error of a curve that has `missing_parts`, with columns as of `guess_roles`.

    Of the names of columns, the ``wrong`` ones are those of no column, or of several.
    """
    lacks = [*(f"one column {name!r}" for name in wrong), *missing_parts(columns, calibration)]
    options: dict[str, str] = {}
    if of_columns := [lack for lack in lacks if lack not in OPTIONS]:
        if len(heads) > SHOWN and not any(head.text for head in heads):
            raise ConfigError(
                f"{where} has {len(heads)} columns without names, as a matrix of heights has; if "
                "it is a curve, choose columns by their numbers (--columns on the command line)"
            )
        typed = {text.split()[0]: name for name, text in (calibration.columns or {}).items()}
        known = {role: c._replace(name=typed.get(role, c.name)) for role, c in columns.items()}
        roles = guess_roles(heads, known)
        text = ", ".join(
            f"{roles[role].name} = {role} {roles[role].unit or '<unit>'}"
            for role in NAMES
            if role in roles
        )
        options = dict.fromkeys(of_columns, f'--columns "{text}"')
        lacks = missing_parts(roles, calibration)
    options |= {lack: OPTIONS[lack] for lack in lacks if lack in OPTIONS}
    names = [excerpt(head.text or head.name) for head in heads[:SHOWN]]
    names += ["…"] if len(heads) > SHOWN else []
    return MissingInputError(f"{where} has {', '.join(names) or 'no columns'}; ", options)


def guess_roles(heads: Sequence[Column], known: Columns) -> dict[str, Column]:
    """Return columns by the roles that they may have; a unit that is not known is empty.

    Those that are ``known`` come first.
    """
    columns = [(role, column.name, column) for role, column in known.items()]
    others: list[tuple[str, str, Column]] = []
    called = Counter(text for h in heads for text in {h.name.lower(), h.text.lower()})
    for index, head in enumerate(heads):
        names = (t for t in (head.name, head.text) if called[plain(t).lower()] == 1)
        name = next((text for text in names if not _UNSAFE.search(text)), str(index + 1))
        words = (role for role, of in _ROLES.items() if re.search(of, head.name.lower()))
        word, of_unit = next(words, ""), _BY_UNIT.get(si_unit(head.unit), "")
        (columns if word else others).append((word or of_unit, name, head))
    guesses: dict[str, tuple[str, Column]] = {}
    for role, name, head in columns + others:
        is_signal = role in ("force", "deflection")
        kind = "signal" if is_signal else role if role in ("", "time") else "place"
        # A force and a deflection tell the spring constant.
        kind = role if is_signal and {"force", "deflection"} <= known.keys() else kind
        allowed = "mNVA" if is_signal else UNITS.get(role, "m")
        units = [head.unit, *reversed(re.split(r"[\W_]+", head.name))]
        unit = next((u for u in units if si_unit(u) in [*allowed]), "")
        contradicts = si_unit(head.unit) or _IN_SECONDS.search(head.name.lower())
        if not unit and contradicts:
            continue
        if unit and is_signal:
            # Instruments call a signal in any unit a deflection.
            role = "force" if si_unit(unit) == "N" else "deflection"
        if kind and (unit or kind != "time" or role in known):
            guesses.setdefault(kind, (role, Column("", name, unit)))
    unknown = "deflection", Column("", UNKNOWN, "")
    signal, _ = guesses.get("deflection") or guesses.setdefault("signal", unknown)
    role, place = guesses.setdefault("place", ("height", Column("", UNKNOWN, "")))
    if role == "height" and role not in known and place.name != UNKNOWN:
        # Most heights fall as the tip goes down, and most others grow; which it is shows in a fit.
        # Beside a deflection, in whatever unit, the place is that of the base.
        is_bent = any(re.search(_ROLES["deflection"], head.name.lower()) for head in heads)
        if signal == "force" and not is_bent and not _OF_BASE.search(place.name.lower()):
            guesses["place"] = "position", place
        elif "height" not in place.name.lower():
            guesses["place"] = "extension", place
    return dict(guesses.values())
