"""Which curves of a population are accepted, to which group they belong, and which stand out."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from pellicle.errors import ConfigError, StorageError, shown
from pellicle.files import read_text
from pellicle_fit.parameters import MODULUS

from .rules import Rule, is_closed, values

GROUP = "{group}"
"""The part of a pattern of file names that is the name of the group."""
_FEWEST = 5
"""Least number of curves among which one can stand out."""
_NORMAL = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation."""
_LIMIT = 3.5
"""Distance from the median, in these deviations, beyond which a curve stands out."""
_HEADS = ("curve", "name", "file")
_PATTERN = re.compile(r"[*?[]")

Row = dict[str, Any]


@dataclass(frozen=True)
class Names:
    """A list of curves in a file."""

    path: Path
    reasons: Mapping[str, str]
    """What follows each name on its line."""

    @cached_property
    def _literal(self) -> dict[str, str]:
        return {name.replace("\\", "/"): name for name in self.reasons}

    @cached_property
    def _patterns(self) -> list[str]:
        return [name for name in self.reasons if _PATTERN.search(name)]

    def entry(self, curve: str) -> str | None:
        """Return the name in the list that means a curve: its name or the end of it, or a pattern.

        The end follows a slash: ``a.csv`` means ``day/a.csv``.
        """
        path = curve.replace("\\", "/")
        parts = path.split("/")
        for start in range(len(parts)):
            if (end := "/".join(parts[start:])) in self._literal:
                return self._literal[end]
        for name in self._patterns:
            if fnmatchcase(path, name) or fnmatchcase(path, f"*/{name}"):
                return name
        return None


def read_names(path: Path | None) -> Names | None:
    """Return the list of curves in a text file: a name on each line, and after a comma a reason.

    Raises
    ------
    StorageError
        The file cannot be read.
    """
    if path is None:
        return None
    try:
        lines = read_text(path).splitlines()
        rows = [row for row in csv.reader(lines) if row and not row[0].lstrip().startswith("#")]
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise StorageError(f"{path}: cannot be read as a list of curves ({reason})") from None
    reasons = {row[0].strip(): ", ".join(cell.strip() for cell in row[1:]) for row in rows}
    return Names(path, {k: v for k, v in reasons.items() if k and k.lower() not in _HEADS})


def group_pattern(group_by: str) -> re.Pattern[str] | None:
    """Return the regular expression of a pattern of file names; None if it names a column.

    ``{group}`` and ``*`` stand for any characters but slashes, ``?`` for one of them.

    Raises
    ------
    ConfigError
        The pattern has more than one group.
    """
    if GROUP not in group_by:
        return None
    if group_by.count(GROUP) > 1:
        raise ConfigError(f"{shown(group_by)} has {GROUP} twice; write it once", "group_by")
    parts = {GROUP: "(?P<group>[^/]+?)", "*": "[^/]*", "?": "[^/]"}
    pieces = re.split(r"(\{group\}|\*|\?)", group_by.replace("\\", "/"))
    return re.compile("(?:.*/)?" + "".join(parts.get(p, re.escape(p)) for p in pieces))


def group_of(pattern: re.Pattern[str] | None, file: str, column: str) -> str:
    """Return the group of a curve: that of its file name or, without a pattern, of its column."""
    if pattern is None:
        return column
    match = pattern.fullmatch(file.replace("\\", "/"))
    return match["group"] if match else ""


def judge(
    rows: Sequence[Row], rules: Sequence[str], accepted: Names | None, rejected: Names | None
) -> list[str]:
    """Set ``accepted``, ``reason`` and ``outlier`` of each row, and return notes.

    A curve is accepted if it was fitted, is not in the list of rejected curves, is in that of
    accepted ones if there is one, and obeys all rules.  Outliers stay accepted.
    """
    checks = [Rule(text) for text in rules]
    used: set[tuple[Path, str]] = set()
    for row in rows:
        row["reason"] = _reason(row, checks, accepted, rejected, used)
        row["accepted"] = not row["reason"]
        row["outlier"] = False
    notes = [
        f"{names.path} names {shown(name)}, which is none of the curves"
        for names in (accepted, rejected)
        if names is not None
        for name in names.reasons
        if (names.path, name) not in used
    ]
    whole = [row for row in rows if row["accepted"]]
    if rows and not whole:
        notes.append(f"none of {len(rows)} curves was accepted")
    elif len(whole) < sum(MODULUS.name in row for row in rows):
        lost = sum(MODULUS.name in row for row in rows) - len(whole)
        curves = "curve was" if lost == 1 else "curves were"
        notes.append(f"{lost} fitted {curves} rejected; the table says why")
    for group in dict.fromkeys(row.get("group", "") for row in whole):
        members = [row for row in whole if row.get("group", "") == group]
        for row in outliers(members):
            row["outlier"] = True
    if count := sum(row["outlier"] for row in rows):
        few = [row["curve"] for row in rows if row["outlier"]]
        more = f" and {count - 5} more" if count > 5 else ""
        notes.append(
            f"the modulus of {count} of {len(whole)} accepted curves stands out from that of the "
            f"others in the group; nothing was left out: {', '.join(few[:5])}{more}"
        )
    return notes


def _reason(
    row: Row,
    rules: Sequence[Rule],
    accepted: Names | None,
    rejected: Names | None,
    used: set[tuple[Path, str]],
) -> str:
    """Return why a curve is not accepted; empty if it is."""
    entries = {}
    for names in filter(None, (accepted, rejected)):
        if (entry := names.entry(row["curve"])) is not None:
            used.add((names.path, entry))
            entries[names.path] = entry
    if MODULUS.name not in row:
        return str(row["status"])
    if rejected is not None and rejected.path in entries:
        why = rejected.reasons[entries[rejected.path]]
        return f"in {rejected.path.name}{f': {why}' if why else ''}"
    if accepted is not None and accepted.path not in entries:
        return f"not in {accepted.path.name}"
    numbers = values(row)
    return "; ".join(filter(None, (rule.objection(numbers) for rule in rules)))


def outliers(rows: Sequence[Row]) -> list[Row]:
    """Return the rows whose log E* is further from the median than 3.5 robust deviations.

    Rows with an open interval of it are left out.
    The deviation is 1.4826 times the median absolute deviation, which some of the outliers
    themselves do not change (Iglewicz and Hoaglin, 1993).
    """
    rows = [row for row in rows if is_closed(row[MODULUS.name])]
    if len(rows) < _FEWEST:
        return []
    logarithms = np.log([row[MODULUS.name]["value"] for row in rows])
    distance = np.abs(logarithms - np.median(logarithms))
    limit = _LIMIT * _NORMAL * float(np.median(distance))
    return [row for row, far in zip(rows, distance > limit, strict=True) if far and limit > 0]
