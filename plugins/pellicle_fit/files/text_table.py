"""Tables of numbers in text files, as instruments and spreadsheets export them."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import chain
from pathlib import Path

from pellicle.errors import ConfigError, StorageError
from pellicle.files import fault_of_commas, read_text
from pellicle.memory import require_for

from .columns import EXAMPLE, NAMES, Calibration, Column, Columns, is_curve, plain, si_unit
from .decimal_commas import is_amount, is_number, numbers, refuse_wide, set_points
from .missing import UNKNOWN, guess_roles

FILE = "file"
"""Name of the column of a table that lists files."""
_HEAD = re.compile(r"([^\[(]*)(?:[\[(]([^\])]*)[\])])?")
_WORD = re.compile(r"[^\s\[(]+(?:\s?[\[(][^\])]*[\])])?")
"""A column's name and unit in a header whose columns are separated by spaces."""
_PER_BYTE, _PER_CELL = 3.0, 300.0
"""Memory [bytes] that a text takes for each of its bytes, and at most for each cell."""
_COMMENT = ("#", "%")
_PREAMBLE = 200
"""Lines in which a header is sought."""
_EXPORT = re.compile(r"[#%]\s*(columns|units):(.*)")
"""A comment of JPK's text exports with the names of the columns, or with their units."""
_PAIR = re.compile(
    r"([^:=;,\t\[(]+?)\s*(?:[\[(]([^\])]*)[\])])?[\s:=;,]+([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*"
    r"([^\s\"';,]*)"
)
"""Name, unit, value and, in place of the first, unit of a constant in a line above a table."""
_CONSTANTS = {
    **dict.fromkeys(("k", "springconstant", "cantileverspringconstant"), "spring_constant"),
    **dict.fromkeys(("sensitivity", "deflectionsensitivity", "invols"), "sensitivity"),
}
"""Constants that are read, by their letters."""


def _lines(path: Path) -> tuple[list[str], list[int]]:
    """Return the lines of a text, and the numbers of those without comments."""
    purpose = f"{path} as a text", "export a part of it"
    with suppress(OSError):
        require_for(_PER_BYTE * path.stat().st_size, *purpose)
    try:
        # Some programs write minus signs of their own.
        text = read_text(path).replace("\N{MINUS SIGN}", "-")
    except OSError as error:
        raise StorageError(f"{path}: cannot be read ({error.strerror or error})") from None
    except ValueError as error:
        raise csv.Error from error
    require_for(_PER_CELL * sum(map(text.count, ",;\t \n")), *purpose)
    lines = [line for line in text.splitlines() if line.strip()]
    data = [number for number, line in enumerate(lines) if not line.startswith(_COMMENT)]
    if not data:
        raise ConfigError(f"{path}: is empty; give a table with the header {EXAMPLE!r}")
    return lines, data


def read_list(path: Path, mapped: Mapping[str, str]) -> list[dict[str, str]]:
    """Return the fields of each row of a table with a column ``file``; none of another table.

    Each row below its header is as long, and has no number in that column.  One that has the
    columns of a curve, or ``mapped`` ones, is another table.
    """
    with suppress(csv.Error):
        lines, data = _lines(path)
        for number, heads in _candidates(lines, data).items():
            names = [head.name.lower() for head in heads]
            is_other = is_curve({*names}) or any(h.is_called(n) for n in mapped for h in heads)
            if is_other or FILE not in names:
                continue
            rows, separator = _rows(lines, data, number)
            if separator == " " and len(heads) == 1:
                rows = [[" ".join(row)] for row in rows]
            place = names.index(FILE)
            if rows and all(len(r) >= len(heads) and not is_number(r[place]) for r in rows):
                rows = [list(map(str.strip, row)) for row in rows]
                if separator == ",":
                    wide = [row for row in rows if any(map(is_amount, row[len(heads) :]))]
                    refuse_wide(wide, len(heads), path)
                else:
                    of = {k: f"{path}: column {name}" for k, name in enumerate(names) if k != place}
                    set_points(rows, of)
                cells = [zip(heads, row, strict=False) for row in rows]
                return [{h.name.lower(): f"{c} {h.unit}".strip() for h, c in r if c} for r in cells]
    return []


def _rows(lines: Sequence[str], data: Sequence[int], header: int) -> tuple[list[list[str]], str]:
    """Return the cells of the rows below a header, and what separates them."""
    below = [lines[number] for number in data if number > header]
    # The heads may be separated by other signs than the numbers, and a first row be short.
    separator = next((s for s in map(_separator, below[:3]) if s != " "), " ")
    return _split(below, separator), separator


def _with_units(heads: Sequence[Column], units: Sequence[str]) -> list[Column]:
    """Return columns with the units of a row, where they have none."""
    units = [unit if si_unit(unit) else "" for unit in units] + [""] * len(heads)
    return [h._replace(unit=h.unit or unit) for h, unit in zip(heads, units, strict=False)]


def _agreed(
    heads: Sequence[Column], words: Sequence[Column], path: Path, *, is_below: bool = False
) -> list[Column]:
    """Return columns with the units of another line, which may be a header or a row of units.

    One that names another column, or another unit, is a ConfigError.  Some words of the line right
    ``below`` the header may be no units.
    """
    names, others = ([column.name.lower() for column in of] for of in (heads, words))
    is_header = names == others or (is_curve({*names}) and is_curve({*others}))
    units = [word.unit or word.name for word in words]
    text, same = ", ".join(word.text for word in words), len(names) == len(others)
    if is_header:
        pairs = zip(names, others, strict=True) if same else ()
        swapped = any(a != b and {a, b} <= {*NAMES} for a, b in pairs)
        if swapped or {*others} & {*NAMES} - {*names, "time"}:
            raise ConfigError(f"{path}: has two headers, of which one is {text!r}; delete one")
        by_name = {word.name.lower(): word.unit for word in words}
        units = [w.unit for w in words] if same else [by_name.get(name, "") for name in names]
    units = [u if h.takes(u) else "" for h, u in zip(heads, units, strict=False)]
    if not (is_header or is_below or (same and all(units))):
        return [*heads]
    for head, unit in zip(heads, units, strict=False):
        if head.contradicts(unit):
            raise ConfigError(
                f"{path}: column {head.name!r} is in {head.unit} by one line and in {unit} by "
                f"another, {text!r}; delete the one that is wrong"
            )
    return _with_units(heads, units)


def _key(name: str) -> str:
    """Return the letters of a name."""
    return re.sub("[^a-z]", "", name.lower())


def _constants(lines: Sequence[str], is_export: bool) -> dict[str, float]:
    """Return constants that lines state with their units; JPK's export has them in SI."""
    constants: dict[str, set[float]] = {}
    for match in filter(None, (_PAIR.match(plain(text[:200]).lstrip('#%\\*" ')) for text in lines)):
        key, unit, number, second_unit = match.groups(default="")
        name, unit = _CONSTANTS.get(_key(key)), unit or second_unit
        with suppress(ValueError):
            number = number.replace(",", ".")
            value = float(number) if is_export and not unit else f"{number} {unit}"
            if name:
                constants.setdefault(name, set()).add(getattr(Calibration(**{name: value}), name))
    return {name: values.pop() for name, values in constants.items() if len(values) == 1}


def _header(
    lines: Sequence[str], data: Sequence[int], mapped: Mapping[str, str]
) -> tuple[int, list[Column]]:
    """Return the number of the line above the rows, and its heads.

    It is the first line that has the ``mapped`` columns or, without them, those of a curve, or may
    have them, or the last such comment above it; else the first line or, if that is a row, a
    comment with as many words.
    """
    heads = _candidates(lines, data)
    keys = [name for name in mapped if not name.isdecimal()]
    for number, columns in heads.items():
        names = {head.name.lower() for head in columns}
        is_known = not mapped and is_curve(names)
        if is_known or (keys and all(any(h.is_called(name) for h in columns) for name in keys)):
            return number, columns
    width = len(_heads(lines[data[-1]]))
    alike = {number: columns for number, columns in heads.items() if len(columns) == width}
    for number, columns in () if mapped else alike.items():
        if all(column.name != UNKNOWN for column in guess_roles(columns, {}).values()):
            return number, columns
    if data[0] in heads:
        return data[0], heads[data[0]]
    comments = (n for n in alike if n < data[0] and ":" not in _EXPORT.sub(r"\2", lines[n]))
    return data[0] - 1, alike.get(next(comments, -1), [])


def _candidates(lines: Sequence[str], data: Sequence[int]) -> dict[int, list[Column]]:
    """Return what the lines may name that may be a header, by the numbers of the lines.

    Those of an export that says so come first, then the first lines, then comments upwards.
    """
    above = [*reversed(range(data[0]))]
    exported = [n for n in above if (match := _EXPORT.match(lines[n])) and match[1] == "columns"]
    likely = [*exported, *data[:_PREAMBLE]]
    cells = {number: re.split(r"[\s;,]+", lines[number].strip()) for number in [*likely, *above]}
    return {n: _heads(lines[n]) for n in cells if not all(map(is_number, filter(None, cells[n])))}


def _heads(line: str) -> list[Column]:
    if match := _EXPORT.match(line):
        line = match[2]
    line = line.lstrip("".join(_COMMENT))
    separator = _separator(line)
    return _named(
        _WORD.findall(line.replace('"', "")) if separator == " " else _split([line], separator)[0]
    )


def _named(cells: Sequence[str]) -> list[Column]:
    """Return columns by the cells of a header."""
    heads = []
    for text in map(plain, cells):
        match = _HEAD.fullmatch(text)
        name, unit = match.groups(default="") if match else (text, "")
        heads.append(Column(text, name.strip(), unit.strip()))
    return heads


def _separator(line: str) -> str:
    line = line.strip()
    if "\t" in line or ";" in line:
        return max("\t;", key=line.count)
    # Between blanks, commas are decimal.
    words = line.split() if re.search(r"\d,\d", line) else []
    is_decimal = len(words) > 1 and all(is_number(w) and w.strip(",") == w for w in words)
    return "," if "," in line and not is_decimal else " "


def _split(lines: Sequence[str], separator: str) -> list[list[str]]:
    if separator == " ":
        return [line.replace('"', "").split() for line in lines]
    return list(csv.reader(lines, delimiter=separator))


def read_table(
    path: Path, mapped: Mapping[str, str]
) -> tuple[dict[str, Columns], list[Column], dict[str, float]]:
    """Return columns of the curve of a table, all heads, and constants that it states.

    These stand in lines above it, or are the same in all rows of a column.
    The columns are those with known names, or ``mapped`` ones, or those of JPK's text export.  A
    row of units may follow the header, and the columns of a table without one have numbers.  What
    is no text, or has a cell that is longer than any number, is a csv.Error.
    """
    lines, data = _lines(path)
    header, heads = _header(lines, data, mapped)
    rows, separator = _rows(lines, data, header)
    above = sorted({*range(data[-1])} - {n for n in data if n >= header})
    stated = [lines[n] for n in above]
    others = (_heads(lines[n]) for n in above if n != header and not _EXPORT.match(lines[n]))
    below = (_named(row) for row in rows if not any(map(is_number, row)))
    if rows and not any(map(is_number, rows[0])):
        heads = _agreed(heads, _named(rows.pop(0)), path, is_below=True)
    for words in chain(others, below):
        heads = _agreed(heads, words, path)
    exported: dict[str, list[str]] = {}
    for match in filter(None, map(_EXPORT.match, stated)):
        if exported.setdefault(match[1], cells := match[2].split()) != cells:
            raise ConfigError(f"{path}: its segments differ in {match[1]}; export one at a time")
    heads, is_export = _with_units(heads, exported.get("units", [])), len(exported) == 2
    width = max(map(len, rows[:1]), default=0)
    heads += [Column("", str(index + 1), "") for index in range(len(heads), width)]
    rows = [row + [""] * (len(heads) - len(row)) for row in rows]
    stated += [
        f"{head.name} [{head.unit}] = {rows[0][place]}"
        for place, head in enumerate(heads)
        if _key(head.name) in _CONSTANTS and len({row[place] for row in rows}) == 1
    ]
    names = [head.name.lower() for head in heads]
    named = max((place for place, head in enumerate(heads, 1) if head.text), default=0)
    if named and (not all(map(str.isdecimal, mapped)) if mapped else is_curve({*names})):
        filled = ([cell for cell in row if cell.strip()] for row in rows)
        wide = [row for row in filled if len(row) > named and all(map(is_number, row))]
        refuse_wide(wide, named, path)
    # A curve has two columns, which would be four of whole numbers.
    may_split = separator == "," and not named and len(heads) > max(len(mapped), 3)
    if may_split and (reason := fault_of_commas(rows)):
        raise ConfigError(f"{path}: {reason}")
    known = mapped or {name: name for name in names if name in NAMES}
    if is_export and not mapped:
        # The position of the tip is that of a height, and time, unlike seriesTime, begins anew.
        roles = guess_roles([head for head in heads if "tip" not in head.name.lower()], {})
        if "height" in roles:
            known = {c.name: role for role, c in roles.items() if c.name != UNKNOWN}
    columns, places = {}, dict[str, int]()
    for name in known:
        matches = [index for index, head in enumerate(heads) if head.is_called(name)]
        if not matches and name.isdecimal() and 1 <= int(name) <= len(heads):
            matches = [int(name) - 1]
        if len(matches) == 1:
            places[name] = matches[0]
    # Decimals of one column tell what a mark means in another.
    cells = {place: [row[place].strip() for row in rows] for place in places.values()}
    decimals = [cell for texts in cells.values() for cell in texts if "." in cell]
    for name, place in places.items():
        role, _, unit = known[name].partition(" ")
        head = heads[place]
        values = numbers(cells[place], decimals, separator, f"{path}: column {head.name}")
        # Heads that are doubled do not tell which column is which.
        is_doubled = sum(head_beside.text == head.text for head_beside in heads) > 1
        unit = unit if unit and is_doubled else head.unit_beside(unit, path)
        columns[role] = head._replace(unit=unit, values=values)
    return {"": columns}, heads, _constants(stated, is_export)
