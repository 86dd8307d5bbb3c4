"""Which curves of a population are accepted, to which group they belong, and which stand out."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Sequence
from itertools import compress
from pathlib import Path

import numpy as np
import pandas as pd

from pellicle.errors import ConfigError, StorageError, excerpt
from pellicle.files import read_text
from pellicle.schema import evaluate, names_in, nearest
from pellicle.units import readable, split, unit_quantity
from pellicle_fit.estimation.coordinates import MODULUS
from pellicle_fit.selection.verdict import Verdict

from .row import Row, accepted_estimates, units

_SIGNS: dict[str, Callable[[float, float], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}
_COMPARISON = re.compile(f"({'|'.join(_SIGNS)})")
_EXAMPLE = "write one such as 'r_squared > 0.95' or '1 kPa < reduced_modulus < 1 MPa'"
_FEWEST = 5
"""Least number of curves among which one can stand out."""
_NORMAL = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation."""
_LIMIT = 3.5
"""Distance from the median, in these deviations, beyond which a curve stands out."""


class Rule:
    """One or two comparisons of expressions and quantities; names and dimensions are checked."""

    def __init__(self, text: str) -> None:
        rule, unit_of = excerpt(text), units()
        parts = [part.strip() for part in _COMPARISON.split(text)]
        self.text, self._signs, sides = text, parts[1::2], parts[::2]
        self._sides: list[float | str] = []
        self._units: dict[str, str] = {}
        dimensions = {}
        for side in sides if len(sides) in (2, 3) and all(sides) else ():
            number, unit = split(side) or (0.0, "")
            is_quantity = unit[:1].isalpha()
            names = set[str]() if is_quantity else names_in(side)
            for name in sorted(names - unit_of.keys()):
                raise ConfigError(f"{excerpt(name)} in {rule}: {nearest(name, unit_of)}")
            ones = {
                name: 1.0 if unit_of[name] == "1" else unit_quantity(unit_of[name])
                for name in names
            }
            value = number * unit_quantity(unit) if is_quantity else evaluate(side, ones)
            # A bare number is in SI.
            if is_quantity or names:
                dimensions[str(getattr(value, "dimensionality", "dimensionless"))] = side
            self._sides.append(float(value.magnitude) if is_quantity else side)
            self._units |= {name: unit_of[name] for name in names}
        if not self._units:
            raise ConfigError(f"{rule} does not compare a number of the fit; {_EXAMPLE}")
        if len(dimensions) > 1:
            texts = " with ".join(f"{side} ({name})" for name, side in dimensions.items())
            raise ConfigError(f"{rule} compares {texts}; {_EXAMPLE}")

    def objection(self, row: Row) -> str:
        """Return why a fit breaks the rule; empty if it does not."""
        known = row.fit.values()
        known |= {name: e.value for name in row.fit.estimates() if (e := row.fit.best(name))}
        numbers = {name: known.get(name, np.nan) for name in sorted(self._units)}
        sides = [float(evaluate(s, numbers) if isinstance(s, str) else s) for s in self._sides]
        pairs = zip(sides[:-1], self._signs, sides[1:], strict=True)
        if not any(map(np.isnan, sides)) and all(_SIGNS[sign](a, b) for a, sign, b in pairs):
            return ""
        texts = (
            f"{name} is {'unknown' if np.isnan(v) else readable(v, self._units[name], 4)}"
            for name, v in numbers.items()
        )
        return f"{', '.join(texts)}, against {self.text}"


class Names:
    """A list of curves in a text file: a name on each line, and after a comma a reason."""

    def __init__(self, path: Path) -> None:
        try:
            lines = [line for line in read_text(path).splitlines() if not line.startswith("#")]
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise StorageError(f"{path}: cannot be read as a list of curves ({reason})") from None
        pairs = [line.replace("\\", "/").partition(",") for line in lines if line.strip()]
        self.path, self.reasons = path, {name.strip(): why.strip() for name, _, why in pairs}

    def entry(self, row: Row) -> str:
        """Return the name in the list that means a curve: ``a.csv`` means ``day/a.csv`` too."""
        parts = row.name.replace("\\", "/").split("/")
        ends = ("/".join(parts[start:]) for start in range(len(parts)))
        return next((end for end in ends if end in self.reasons), "")


def group_of(group_by: str, file: str, column: str) -> str:
    """Return the group of a curve: a part of its file name or, without a pattern, ``column``.

    In a pattern ``{group}`` and ``*`` stand for any characters but slashes.
    """
    if "{group}" not in group_by:
        return column
    text = re.escape(group_by.replace("\\", "/")).replace(r"\*", "[^/]*")
    pattern = "(?:.*/)?" + text.replace(r"\{group\}", "([^/]+?)")
    match = re.fullmatch(pattern, file.replace("\\", "/"))
    return match[1] if match else ""


def judge(rows: Sequence[Row], rules: Sequence[str], rejected: Names | None) -> list[str]:
    """Set ``accepted``, ``reason`` and ``outlier`` of each row, and return notes.

    A curve is accepted if it was fitted, is not in the list of rejected curves, and obeys all
    rules; if there are none, if a model describes it.  Outliers stay accepted.
    """
    checks, notes = [Rule(text) for text in rules], []
    if rejected:
        used = {rejected.entry(row) for row in rows}
        unknown = [excerpt(name) for name in rejected.reasons if name not in used]
        notes += [f"{rejected.path} names {n}, which is none of the curves" for n in unknown]
    for row in rows:
        if not row.is_fitted:
            row.reason = row.status
        elif rejected and (entry := rejected.entry(row)):
            why = rejected.reasons[entry]
            row.reason = f"in {rejected.path.name}{f': {why}' if why else ''}"
        elif not checks and row.fit.verdict is Verdict.UNDESCRIBED:
            # The plainest is the first.
            row.reason = row.fit.curve["failed_checks"][0]["message"]
        else:
            row.reason = "; ".join(filter(None, (rule.objection(row) for rule in checks)))
        row.accepted = not row.reason
    whole = [row for row in rows if row.accepted]
    lost = sum(row.is_fitted for row in rows) - len(whole)
    if rows and not whole:
        notes.append(f"none of {len(rows)} curves was accepted")
    elif lost:
        curves = "curve was" if lost == 1 else "curves were"
        notes.append(f"{lost} fitted {curves} rejected; the table says why")
    far = set(outliers(whole))
    for row in rows:
        row.outlier = row in far
    return notes


def outliers(rows: Sequence[Row]) -> list[Row]:
    """Return the rows whose log E* is further from the median than 3.5 robust deviations.

    The median is that of the group; a row whose interval holds it does not stand out.
    The deviation is 1.4826 times the median absolute deviation, which some of the outliers
    themselves do not change (Iglewicz and Hoaglin, 1993).
    """
    found = accepted_estimates(rows, MODULUS)
    known = [(e.value, e.low or 0.0, np.inf if e.high is None else e.high) for e in found.values()]
    with np.errstate(divide="ignore"):
        values = np.log(np.reshape(known, (-1, 3)))
    logarithms, low, high = (pd.Series(column) for column in values.T)
    groups = pd.Series([row.group for row in found], dtype=object)
    medians = logarithms.groupby(groups).transform("median")
    distances = (logarithms - medians).abs()
    limits = _LIMIT * _NORMAL * distances.groupby(groups).transform("median")
    sizes = logarithms.groupby(groups).transform("size")
    far = (distances > limits) & ((medians < low) | (medians > high))
    return list(compress(found, far & (limits > 0) & (sizes >= _FEWEST)))
