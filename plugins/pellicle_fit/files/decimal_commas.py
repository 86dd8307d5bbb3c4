"""Numbers in the cells of tables, whose commas are decimal or else refused."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError

_WHOLE = re.compile(r"[-+]?[1-9]\d{0,2}")
_GROUPED = re.compile(rf"{_WHOLE.pattern}(?:,\d{{3}})+")
"""A number whose thousands may be separated by commas."""
_SPACED = re.compile(r"[-+]?\d{1,3}([ '’\u00a0\u202f]\d{3})+([.,]\d*)?")
"""A number whose thousands are separated by other signs."""
_AMOUNT = re.compile(r"([-+]?[\d.,]+(?:[eE][-+]?\d+)?)(\s*[^\d\s]*)")
"""A number, and perhaps its unit."""


def is_number(cell: str) -> bool:
    """Return whether a cell holds a number, perhaps with a decimal comma."""
    try:
        float(cell.replace(",", ".", 1))
    except ValueError:
        return False
    # Python takes 1_0 for 10.
    return "_" not in cell


def is_amount(cell: str) -> bool:
    """Return whether a cell holds a number, perhaps with a unit."""
    return bool(_AMOUNT.fullmatch(cell))


def refuse_wide(wide: Sequence[Sequence[str]], named: int, path: Path) -> None:
    """Raise if there are rows of more numbers than ``named`` columns."""
    for row in wide:
        raise ConfigError(
            f"{path}: has {len(row)} numbers below {named} names ({','.join(row)}), as where "
            "commas are decimal and separate columns too, or rows are numbered; export it with "
            "semicolons, tabs or decimal points, name each column, or choose columns of a curve by "
            "their numbers (--columns on the command line)"
        )


def set_points(rows: list[list[str]], columns: Mapping[int, str]) -> None:
    """Replace decimal commas in cells of some columns, with their names, by points.

    The numbers may have units.
    """
    amounts = {k: [_AMOUNT.fullmatch(row[k]) for row in rows] for k in columns}
    known = {k: [m[1] for m in of if m and is_number(m[1])] for k, of in amounts.items()}
    decimals = [number for of in known.values() for number in of if "." in number]
    for k, name in columns.items():
        _check_commas(known[k], decimals, name)
        for row, match in zip(rows, amounts[k], strict=True):
            if match and is_number(match[1]):
                row[k] = match[1].replace(",", ".") + match[2]


def numbers(cells: list[str], decimals: list[str], separator: str, column: str) -> Array:
    """Return numbers; NaN where a cell holds none.

    A comma in them is decimal, or refused, as where commas separate columns.
    """
    _check_commas(cells, decimals, column, is_separator=separator == ",")
    for cell in filter(_SPACED.fullmatch, cells):
        raise ConfigError(f"{column} has {cell!r}; export it without separators of thousands")
    return np.array([float(c.replace(",", ".")) if is_number(c) else np.nan for c in cells])


def _check_commas(
    cells: Sequence[str], decimals: Sequence[str], column: str, *, is_separator: bool = False
) -> None:
    """Raise if commas in cells may not be decimal: beside ``decimals`` with a point, say."""
    digits = [cell for cell in cells if is_number(re.sub("[.,]", "", cell))]
    commas, beside = ([cell for cell in digits if mark in cell] for mark in ",.")
    if commas and all(map(_GROUPED.fullmatch, commas)):
        beside += filter(_WHOLE.fullmatch, digits)
    beside += (cell for cell in decimals if is_number(cell.replace(".", "")))
    if commas and (beside or is_separator):
        raise ConfigError(
            f"{column} has {commas[0]!r} beside {[*beside, *digits][0]!r}, so its commas may be "
            "those of decimals or of thousands; export it without separators of thousands, and "
            "with decimals in all rows"
        )
