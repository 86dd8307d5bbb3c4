"""Tables of numbers in text files, as instruments and spreadsheets export them."""

from __future__ import annotations

import csv
import re
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError, StorageError, shown
from pellicle.files import read_text
from pellicle.units import Quantity

from .columns import Channel, is_curve
from .roles import EXAMPLE, LABEL, NAMES, role_of

FILE = "file"
"""Name of the column of a table that lists files."""
_HEADER = re.compile(r"([^\[(]*)(?:[\[(]([^\])]*)[\])])?")
_WORD = re.compile(r"[^\s\[(]+(?:\s?[\[(][^\])]*[\])])?")
"""A column's name and unit in a header whose columns are separated by spaces."""
_WHOLE = re.compile(r"[-+]?[1-9]\d{0,2}")
_GROUPED = re.compile(rf"{_WHOLE.pattern}(?:,\d{{3}})+(?:\.\d*)?")
"""A number whose thousands are separated by commas."""
_COMMENT = ("#", "%")
_SPACE = " "
_PREAMBLE = 200
"""Lines in which a header is sought."""
_UNIT_ROWS = 3
"""Rows below a header that may hold units instead of numbers."""
_DIMENSIONS = ("m", "N", "V", "s")


@dataclass(frozen=True)
class Head:
    """The head of a column."""

    text: str
    """All of it."""
    name: str
    unit: str

    @classmethod
    def of(cls, cell: str) -> Head:
        """Return the head in a cell such as ``position [um]``."""
        text = _plain(cell)
        match = _HEADER.fullmatch(text)
        if match is None:
            return cls(text, text, "")
        name, unit = match.groups(default="")
        return cls(text, name.strip(), unit.strip())

    def is_called(self, name: str) -> bool:
        """Return whether a user who writes ``name`` may mean this column."""
        return _plain(name).lower() in (self.text.lower(), self.name.lower())


@dataclass(frozen=True)
class Cells:
    """The cells of a table as texts."""

    heads: tuple[Head, ...]
    """Heads of the columns; none if the table begins with numbers."""
    rows: list[list[str]]
    comma: bool
    """Whether the decimal separator may be a comma."""

    @property
    def names(self) -> list[str]:
        """Names of the columns in lower case."""
        return [head.name.lower() for head in self.heads]

    @property
    def first(self) -> list[str]:
        """Names of the columns, or the first numbers of a table without."""
        return self.names or self.rows[0]

    def name(self, index: int) -> str:
        """Return the name of a column, or its number from 1."""
        return self.heads[index].name if self.heads else str(index + 1)

    def numbers(self, rows: Sequence[Sequence[str]], index: int, path: Path) -> Array:
        """Return a column of some rows; NaN where a cell is missing or holds no number.

        In a column that has points, a comma is not decimal, and may group thousands.

        Raises
        ------
        ConfigError
            Commas may be decimal or group thousands; ``path`` is named.
        """
        cells = [row[index].strip() if index < len(row) else "" for row in rows]
        commas = [cell for cell in cells if "," in cell]
        decimal = self.comma and not any("." in cell for cell in cells)
        grouped = all(map(_GROUPED.fullmatch, commas))
        whole = next(filter(_WHOLE.fullmatch, cells), None) if commas and grouped else None
        if decimal and whole:
            raise ConfigError(
                f"{path}: column {self.name(index)} has {commas[0]!r} beside {whole!r}, so its "
                "commas may be those of decimals or of thousands; export it without separators "
                "of thousands, and with decimals in all rows"
            )
        mark = "." if decimal else "" if grouped else ","
        values = np.full(len(rows), np.nan)
        for number, cell in enumerate(cells):
            with suppress(ValueError):
                values[number] = float(cell.replace(",", mark))
        return values


def read_cells(path: Path, mapped: Mapping[str, str] | None = None) -> Cells | None:
    """Return the cells of a table; None if the file is not text.

    The header is the first line that has the ``mapped`` columns or, without them, those of a curve
    or of a list of files; else the last comment above numbers; else the first line.

    Raises
    ------
    StorageError
        The file cannot be read.
    ConfigError
        The file is empty.
    """
    try:
        text = read_text(path)
    except OSError as error:
        raise StorageError(f"{path}: cannot be read ({error.strerror or error})") from None
    except ValueError:
        return None
    lines = [line for line in text.splitlines() if line.strip()]
    data = [line for line in lines if not line.startswith(_COMMENT)]
    if not data:
        raise ConfigError(f"{path}: is empty; give a table with the header {EXAMPLE!r}")
    try:
        return _table(lines, data, mapped or {})
    except csv.Error:
        # A cell is longer than any number.
        return None


def _table(lines: list[str], data: list[str], mapped: Mapping[str, str]) -> Cells:
    fits = _recogniser(mapped)
    for number, line in enumerate(data[:_PREAMBLE]):
        heads = _heads(line)
        if fits(heads):
            return _below(heads, data[number + 1 :], _separator(line))
    first = _split(data[0], _separator(data[0]))
    if not all(_is_number(cell) for cell in first if cell.strip()):
        return _below(_heads(data[0]), data[1:], _separator(data[0]))
    above = lines[: lines.index(data[0])]
    comments = [_heads(line.lstrip("".join(_COMMENT))) for line in reversed(above)]
    heads = next(filter(fits, comments), ())
    if not heads and comments and len(comments[0]) == len(first):
        heads = comments[0]
    return _below(heads, data, _separator(data[0]))


def _below(heads: tuple[Head, ...], lines: list[str], separator: str) -> Cells:
    """Return the table below its header, after the rows that hold units."""
    if lines and separator == _SPACE:
        separator = _separator(lines[-1])
    rows = [line.split() for line in lines]
    if separator != _SPACE:
        rows = list(csv.reader(lines, delimiter=separator))
    units = []
    for row in rows[:_UNIT_ROWS]:
        if any(map(_is_number, row)):
            break
        units.append([_plain(cell).strip("[]()") for cell in row])
    heads = tuple(
        head if head.unit else Head(head.text, head.name, _first_unit(units, index))
        for index, head in enumerate(heads)
    )
    return Cells(heads, rows[len(units) :] if heads else rows, separator != ",")


def _first_unit(rows: Sequence[Sequence[str]], index: int) -> str:
    cells = [row[index] for row in rows if index < len(row)]
    return next((cell for cell in cells if _is_unit(cell)), "")


def _is_unit(text: str) -> bool:
    for dimension in _DIMENSIONS:
        with suppress(ValueError):
            Quantity(dimension)(f"1 {text}")
            return True
    return False


def _recogniser(mapped: Mapping[str, str]) -> Callable[[tuple[Head, ...]], bool]:
    """Return a function that tells whether heads are those of the table sought."""
    named = [name for name in mapped if not name.isdecimal()]
    if named:
        return lambda heads: all(any(head.is_called(name) for head in heads) for name in named)
    if mapped:
        return lambda heads: False

    def fits(heads: tuple[Head, ...]) -> bool:
        names = {head.name.lower(): Channel("", np.empty(0)) for head in heads}
        return is_curve(names) or FILE in names

    return fits


def _plain(text: str) -> str:
    """Return a text with one kind of µ and of space."""
    return " ".join(unicodedata.normalize("NFKC", text).replace("μ", "µ").split())


def _separator(line: str) -> str:
    line = line.strip()
    if "\t" in line or ";" in line:
        return max("\t;", key=line.count)
    return "," if "," in line else _SPACE


def _split(line: str, separator: str) -> list[str]:
    if separator == _SPACE:
        return line.split()
    return next(csv.reader([line], delimiter=separator), [])


def _heads(line: str) -> tuple[Head, ...]:
    separator = _separator(line)
    cells = _WORD.findall(line) if separator == _SPACE else _split(line, separator)
    return tuple(Head.of(cell) for cell in cells)


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", ".", 1))
    except ValueError:
        return False
    return True


def curves_of(
    path: Path, cells: Cells, mapped: Mapping[str, str]
) -> dict[str, Mapping[str, Channel]]:
    """Return the known columns of each curve of a table, or those that ``mapped`` names.

    Raises
    ------
    ConfigError
        A column is missing, or several have its name.
    """
    indices, units = _mapped(path, cells, mapped) if mapped else _standard_columns(path, cells)
    label = indices.pop(LABEL, None)
    curves: dict[str, list[list[str]]] = {"": cells.rows}
    if label is not None and indices:
        curves = {}
        for row in cells.rows:
            curves.setdefault(row[label].strip() if label < len(row) else "", []).append(row)
    return {
        text: {
            role: Channel(units[role], cells.numbers(rows, index, path), cells.name(index))
            for role, index in indices.items()
        }
        for text, rows in curves.items()
    }


def _standard_columns(path: Path, cells: Cells) -> tuple[dict[str, int], dict[str, str]]:
    names = cells.names
    indices = {name: index for index, name in enumerate(names) if name in (*NAMES, LABEL)}
    is_curve_table = _recogniser({})(cells.heads)
    for row in cells.rows if is_curve_table and not cells.comma else []:
        if len(row) > len(names) and all(map(_is_number, row)):
            raise ConfigError(
                f"{path}: has {len(row)} numbers below {len(names)} names ({','.join(row)}), as "
                "where commas are decimal and separate columns too; export it with semicolons, "
                "tabs or decimal points, or choose columns by their numbers (--columns on the "
                "command line)"
            )
    for name in indices:
        if names.count(name) > 1:
            raise ConfigError(
                f"{path}: has several columns {name}: give one curve to a file, tell curves apart "
                f"by a column {LABEL}, or choose columns by their numbers (--columns on the "
                "command line)"
            )
    return indices, {name: cells.heads[index].unit for name, index in indices.items()}


def _mapped(
    path: Path, cells: Cells, mapped: Mapping[str, str]
) -> tuple[dict[str, int], dict[str, str]]:
    indices, units = {}, {}
    for name, text in mapped.items():
        role = role_of(text)
        index = _index(path, cells, name)
        indices[role.name] = index
        units[role.name] = role.unit or (cells.heads[index].unit if cells.heads else "")
    return indices, units


def _index(path: Path, cells: Cells, name: str) -> int:
    """Return the index of the column with a name or, if none has it, a number."""
    matches = [index for index, head in enumerate(cells.heads) if head.is_called(name)]
    if len(matches) == 1:
        return matches[0]
    width = max((len(cells.heads), *(len(row) for row in cells.rows[:1])))
    if not matches and name.isdecimal() and 1 <= int(name) <= width:
        return int(name) - 1
    has = ", ".join(shown(text) for text in [h.text for h in cells.heads] or cells.first)
    problem = f"has {len(matches)} columns {name!r}" if matches else f"has no column {name!r}"
    raise ConfigError(
        f"{path}: {problem} (it has {has}); give a name of one column, or its number from 1 to "
        f"{width}",
        "columns",
    )
