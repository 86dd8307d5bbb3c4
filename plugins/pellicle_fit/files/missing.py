"""What a file does not say of its curves, and the options to type that say it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pellicle.errors import ConfigError, shown

from .columns import LABEL, NAMES, Calibration, Channel, Columns, lacking
from .heads import Head, guessed

OPTIONS = {
    "spring_constant": '--spring-constant "… N/m"',
    "sensitivity": '--sensitivity "… nm/V"',
    "radius": '--radius "… um"',
    "half_angle": '--half-angle "… degree"',
}
"""How what only the user knows is typed."""
SHOWN = 12
"""Largest number of columns that a message names."""


class MissingInputError(ConfigError):
    """A file lacks what only its user knows: ``options``, by what is missing, say it with a …."""

    def __init__(self, where: str, options: Mapping[str, str]) -> None:
        self.where, self.options = where, options
        typed = " ".join(filter(None, dict.fromkeys(options.values())))
        super().__init__(
            f"{where}missing: {', '.join(options)}"
            + (f"; add, with your values for … and <…>:\n  {typed}" if typed else "")
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.where, self.options)


def missing_in(
    where: str,
    heads: Sequence[Head],
    wrong: Sequence[str],
    columns: Columns,
    calibration: Calibration,
) -> MissingInputError:
    """Return the error of a curve of which something is `lacking`, with columns as `guessed`.

    Of the names of columns, the ``wrong`` ones are those of no column, or of several.
    """
    lacks = [f"one column {name!r}" for name in wrong]
    lacks += lacking(columns, calibration)
    of_columns = [lack for lack in lacks if lack.split()[0] not in OPTIONS]
    text = ""
    if of_columns:
        typed = {text.split()[0]: name for name, text in (calibration.columns or {}).items()}
        known = {role: (typed.get(role, c.name), c.unit) for role, c in columns.items()}
        roles = guessed(heads, known)
        text = ", ".join(
            f"{roles[role][0]} = {role} {roles[role][1] or '<unit>'}"
            for role in (*NAMES, LABEL)
            if role in roles
        )
        then = {role: Channel(unit, np.empty(0), name) for role, (name, unit) in roles.items()}
        others = [lack for lack in lacking(then, calibration) if lack.split()[0] in OPTIONS]
        lacks = [*of_columns, *others]
    names = [shown(head.text or head.name) for head in heads[:SHOWN]]
    names += ["…"] if len(heads) > SHOWN else []
    return MissingInputError(
        f"{where} has {', '.join(names) or 'no columns'}; ",
        {lack: OPTIONS.get(lack.split()[0], f'--columns "{text}"') for lack in lacks},
    )
