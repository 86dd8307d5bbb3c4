"""Files as laboratories have them: columns of other names, odd headers, MATLAB, nested HDF5."""

import re
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.io import savemat

import pellicle as pl
from pellicle.arrays import Array
from pellicle_fit.files.choice import read
from pellicle_fit.files.cleaning import clean
from pellicle_fit.files.columns import Calibration
from pellicle_fit.files.measurement import Measurement
from pellicle_fit.files.sources import gather

pytestmark = pytest.mark.usefixtures("no_rivals")

Z = np.array([1.5, 2.5, 3.5, 4.5])
"""[um]"""
F = np.array([0.25, 0.5, 1.25, 2.0])
"""[nN]"""
NAN = float("nan")
BY_NUMBER = "1 = position um, 2 = force nN"


def curves(path: Path, columns: str | None = None, **calibration: str) -> dict[str, Measurement]:
    """Return the curves of a file; an error is raised."""
    readers = read(path, Calibration(columns=columns, **calibration))
    return {label: reader() for label, reader in readers.items()}


def is_the_curve(curve: Measurement) -> bool:
    """Whether a curve has the numbers above."""
    return bool(np.allclose(curve.position, 1e-6 * Z) and np.allclose(curve.force, 1e-9 * F))


def rows(separator: str = ",", comma: bool = False, end: str = "\n") -> str:
    """Return the numbers as lines."""
    lines = [f"{z:.4f}{separator}{f:.4f}" for z, f in zip(Z, F, strict=True)]
    text = end.join(lines) + end
    return text.replace(".", ",") if comma else text


def numbered(separator: str) -> str:
    """Return the numbers as lines that begin with their number."""
    lines = rows(separator).splitlines()
    return "\n".join(f"{number}{separator}{line}" for number, line in enumerate(lines))


SHIFTED = {
    "comma": (",", "Z [um],F [nN]", "Z = position, F = force"),
    "semicolon": (";", "position [um];force [nN]", None),
    "tab": ("\t", "Z\tF", "Z = position um, F = force nN"),
    "blank": (" ", "position [um] force [nN]", None),
    "quoted names": (" ", '"position [um]" "force [nN]"', None),
}
"""Separator, header and columns of tables whose rows have a number in front."""
TABLES: dict[str, tuple[str, str | None]] = {
    "comment header": (f"# position [um],force [nN]\n{rows()}", None),
    "last comment": (f"# by A. Nother\n# position [um] force [nN]\n{rows(' ')}", None),
    "header below a preamble": (
        f"Instrument: X\nk (N/m);0,05\n\nposition (um);force (nN)\n{rows(';', True)}",
        None,
    ),
    "row of units": (f"position,force\n[um],[nN]\n{rows()}", None),
    "row of units, semicolons": (f"Position;Force\nµm;nN\n{rows(';', True)}", None),
    "capitals and round brackets": (f"Position (um); Force (nN)\n{rows(';')}", None),
    "tabs and decimal commas": (f"position [um]\tforce [nN]\n{rows(chr(9), True)}", None),
    "decimal commas without header": (rows("\t", True), BY_NUMBER),
    "no header": (rows(), BY_NUMBER),
    "no header, spaces": ("  " + rows("   "), BY_NUMBER),
    "no header, a comment": (f"# whatever was measured\n{rows()}", BY_NUMBER),
    "carriage returns, empty lines": (
        f"position [um],force [nN]\r\n\r\n{rows(end=chr(13) + chr(10) * 2)}",
        None,
    ),
    "Greek mu": (f"position [μm],force [nN]\n{rows()}", None),
    "names of the user": (f"Z,Defl\n{rows()}", "z = position um, Defl = force nN"),
    "unit of the header": (f"Z [um],Defl [nN]\n{rows()}", "Z = position, Defl = force"),
    "whole heads": (f"Z (raw) (um),x,\n{rows()}", "Z (raw) (um) = position um, 2 = force nN"),
    "doubled name by number": (f"force [nN],force [nN]\n{rows()}", BY_NUMBER),
    "a column beyond the header": (
        f"a;b\n{rows(';').replace(';', ';0;')}",
        "1 = position um, 3 = force nN",
    ),
    "columns of one name, one wanted": (f"Z,F,F\n{rows()}", "Z = position um, 2 = force nN"),
    **{
        f"numbered rows, {kind}": (f"{mark}{header}\n{numbered(mark)}", columns)
        for kind, (mark, header, columns) in SHIFTED.items()
        if mark != " "
    },
}


@pytest.mark.parametrize("name", TABLES)
def test_tables(tmp_path: Path, name: str) -> None:
    """Each table has the same numbers, whatever its form."""
    text, columns = TABLES[name]
    path = tmp_path / "Kürve 1 [µ].csv"
    path.write_bytes(text.encode())
    (curve,) = curves(path, columns).values()
    assert is_the_curve(curve)


UNITS = "position [um],force [nN]"
TWO_LINES: dict[str, tuple[str, str | None]] = {
    "units, then remarks": (f"position,force\num,nN\nbead 1,bead 1\n{rows()}", None),
    "remarks, then units": (f"position,force\nbead 1,bead 1\num,nN\n{rows()}", None),
    "remarks that may be units": (f"{UNITS}\nA,A\n{rows()}", None),
    "a remark with a unit": (f"# force N\n{UNITS}\n{rows()}", None),
    "units above names": (f"um,nN\nposition,force\n{rows()}", None),
    "units in a comment": (f"# position force\n# um nN\n{rows(' ')}", None),
    "units twice": (f"{UNITS}\nµm,nN\n{rows()}", None),
    "a header twice": (f"position,force\n{UNITS}\n{rows()}", None),
    "a header below": (f"{UNITS}\n{rows()}{UNITS}\n", None),
    "names of the user": (f"Z,F\nremark,remark\num,nN\n{rows()}", "Z = position, F = force"),
}


@pytest.mark.parametrize("name", TWO_LINES)
def test_two_lines_that_agree(tmp_path: Path, name: str) -> None:
    """Units are read of whichever line states them."""
    text, columns = TWO_LINES[name]
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    curve = curves(tmp_path / "a.csv", columns)[""]
    finite = np.isfinite(curve.force)
    assert is_the_curve(Measurement(curve.position[finite], curve.force[finite]))


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        ("position,force\num,nN\nnm,pN\n{}", None),
        (f"{UNITS}\nnm,pN\n{{}}", None),
        (f"{UNITS}\nnm,pN,remark\n{{}}", None),
        (f"{UNITS}\nposition [nm],force [nN]\n{{}}", None),
        (f"# position [um] force [pN]\n{UNITS}\n{{}}", None),
        (f"# nm nN\n{UNITS}\n{{}}", None),
        (f"{UNITS}\n{{}}position [nm],force [pN]\n{{}}", None),
        (f"{UNITS},time [s]\n{{}}position [nm],force [nN]\n{{}}", None),
        (f"height [um],force [nN]\n{UNITS}\n{{}}", None),
        (f"{UNITS}\nforce [nN],position [um]\n{{}}", None),
        (f"{UNITS},time [s]\nextension [um],force [nN]\n{{}}", None),
        ("extension [um],deflection [nm]\num,V\n{}", None),
        ("Z [um],F [nN]\nZ [nm],F [nN]\n{}", "Z = position, F = force"),
        ("Z,F\num,nN\nnm,nN\n{}", "Z = position, F = force"),
    ],
)
def test_two_lines_that_do_not_agree(tmp_path: Path, text: str, columns: str | None) -> None:
    """They are refused, where the first won without a word."""
    (tmp_path / "a.csv").write_text(text.format(*[rows()] * text.count("{}")), encoding="utf-8")
    with pytest.raises(pl.ConfigError, match=r"has two headers|by one line and in .* by another"):
        curves(tmp_path / "a.csv", columns)


@pytest.mark.parametrize("mark", [";", "\t"])
def test_decimal_commas_in_a_list_of_files(tmp_path: Path, mark: str) -> None:
    """They are read as in tables of curves, with units in the header or in the cells."""
    for name in "ab":
        (tmp_path / f"{name}.csv").write_text(f"position [um],force [nN]\n{rows()}")
    path = tmp_path / "list.csv"
    lines = "file;radius [um];spring_constant;x;y;day\na.csv;2,5;0,05 N/m;1,0 um;0 m;1,2,3\n"
    path.write_text(f"{lines}b.csv;10;50,5 mN/m;-2,5e-1 mm;0 m;Monday\n".replace(";", mark))
    config = pl.FitConfig.merged(indenter="sphere", curves=path, group_by="day")
    first, second = config.sources()
    assert config.indenter_of(first) == pl.indenter("sphere", radius="2.5 um")
    assert config.indenter_of(second) == pl.indenter("sphere", radius="10 um")
    for source, stiffness, x in ((first, 0.05, 1e-6), (second, 0.0505, -2.5e-4)):
        assert isinstance(source.curve, Measurement)
        assert source.curve.stiffness == pytest.approx(stiffness)
        assert source.curve.site == pytest.approx((x, 0))
    assert [source.fields["day"] for source in (first, second)] == ["1,2,3", "Monday"]
    path.write_text("file;radius [um]\na.csv;1,250\nb.csv;500\n".replace(";", mark))
    with pytest.raises(pl.ConfigError, match="those of decimals or of thousands"):
        next(config.sources())


@pytest.mark.parametrize("row", ["a.csv,2,5", "a.csv,2,5,0.05 N/m", "a.csv,2,5,0,05"])
def test_decimal_commas_between_commas_in_a_list_of_files(tmp_path: Path, row: str) -> None:
    """They are refused: 2,5 was a radius of 2."""
    (tmp_path / "a.csv").write_text(f"position [um],force [nN]\n{rows()}")
    path = tmp_path / "list.csv"
    path.write_text(f"file,radius [um]{',spring_constant' * (row.count(',') > 2)}\n{row}\n")
    with pytest.raises(pl.ConfigError, match="as where commas are decimal and separate columns"):
        pl.read_curves(path)
    path.write_text("file,radius [um]\na.csv,2.5,a remark\n")
    assert is_the_curve(*pl.read_curves(path).values())


NUMBERS: list[tuple[str, str | None, list[float], list[float]]] = [
    ("position [um],force [nN]\n1.5,2.7,,a remark\n1.6,2.9\n", None, [1500, 1600], [2.7, 2.9]),
    ("9;5;0;2\n10;6;0;7\n11;1;1;9\n", BY_NUMBER, [9e3, 1e4, 1.1e4], [5, 6, 1]),
    ("position [um]\tforce [nN]\n0\t1\n0,125\t2\n1,125\t3\n", None, [0, 125, 1125], [1, 2, 3]),
    ("depth [nm];force [nN]\n1,5;2,25\n2,5;\n3,5;1_0\n", None, [1.5, 2.5, 3.5], [2.25, NAN, NAN]),
]
"""Tables with their columns, and the positions [nm] and forces [nN] in them."""


@pytest.mark.parametrize(("text", "columns", "position", "force"), NUMBERS)
def test_numbers(
    tmp_path: Path, text: str, columns: str | None, position: list[float], force: list[float]
) -> None:
    """Remarks, whole numbers, decimal commas and cells without a number are taken as such."""
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    curve = curves(tmp_path / "a.csv", columns)[""]
    assert curve.position * 1e9 == pytest.approx(position)
    assert curve.force * 1e9 == pytest.approx(force, nan_ok=True)
    assert curve.is_depth == text.startswith("depth")


LONG = np.linspace(0.0, 1.0, 40)


def both(place: str, deflection: str = "deflection [nm]", k: float = 0.05) -> str:
    """Return a table with force and deflection, of a cantilever with an offset, of 1 N/m."""
    force = 50 * LONG**1.5 - 3
    bend = force / k * (0.01 if "[V]" in deflection else 1.0) + 7
    moved = {"position": 1.0, "height": -1.0}[place] * LONG
    moved = moved - (force / k * 1e-3 if place == "height" else 0.0)
    rows = [f"{z:.6f},{f:.4f},{d:.4f}" for z, f, d in zip(moved, force, bend, strict=True)]
    return "\n".join([f"{place} [um],force [nN],{deflection}", *rows])


WHOLE = "\n".join(f"{z:,}\t{z**1.5 * 1e-3:.3f}" for z in range(0, 1250, 50))
DISTANCES = "\n".join(f"{z}\t{f}\t{f}" for z, f in zip(Z, F, strict=True))
REFUSED: dict[str, list[str | tuple[str, str]]] = {
    # Whether they group thousands is not guessed.
    "without separators of thousands": [
        *(
            f"position [nm]{mark}force [nN]\n999.5{mark}1\n{quote}{cell}{quote}{mark}2\n"
            for mark, quote in (("\t", ""), (";", ""), (",", '"'))
            for cell in ("1,000", "-1,234,567.5", "1,5")
        ),
        *(
            f"position [nm];force [nN]\n999,5;1\n1{mark}000,5;2\n"
            for mark in (" ", "'", "\u00a0", "\u202f", "’")
        ),
    ],
    # Nanometres up to 1,200 are not read as 1.2 nm, which would leave the deep rows out.
    "column position has '1,000' beside '50', so": [f"position [nm]\tforce [nN]\n{WHOLE}"],
    # Where all rows have four digits, the other column tells.
    "may be those of decimals or of thousands": [
        "position [nm];force [nN]\n2,500;-0.01\n3,500;0.5\n",
        "position [nm];force [nN]\n2.500;-0,01\n3.500;0,5\n",
    ],
    # 1,5 at 2,7 was a position of 1 at a force of 5.
    r"has 4 numbers below 2 names \(1,5,2,7\)": [f"{UNITS}\n1,5,2,7\n1,6,2,9\n"],
    "has 4 numbers below 2 names": [
        f"{UNITS}\n{rows(comma=True)}",
        (f"Z [um],F [nN]\n{rows(comma=True)}", "Z = position um, F = force nN"),
    ],
    "each second of which looks like decimals": [
        ("9,5,0,2\n10,6,0,7\n11,1,1,9\n12,3,2,4\n", BY_NUMBER)
    ],
    # Of decimals there would be four.
    "has '1', '2'; missing": ["".join(f"{n},{n}00\n" for n in range(1, 9))],
    # Under a header without its name each column would be taken for the one before.
    "has 3 numbers below 2 names": [
        (f"{header}\n{numbered(mark)}", columns) if columns else f"{header}\n{numbered(mark)}"
        for mark, header, columns in SHIFTED.values()
    ],
    **{
        f"missing: one column '{name}'": [f"{UNITS},{name},{name}\n0,1,2,3\n4,5,6,7\n"]
        for name in ("force", "time")
    },
    # A length is not in seconds, whatever its name is.
    '--columns "<column> = height <unit>, Defl = defl': [
        f"{place}\tDefl [nm]\n{rows(chr(9))}"
        for place in ("Z [s]", "Sensor (ms)", "Ramp_s", "Extension [V]", "Zeit", "Temps", "tiempo")
    ],
    # A signal in volts is no deflection beside one; a force and a deflection are both kept.
    **{
        f'--columns "Distance = {columns}"': [f"Distance (um)\t{signals}\n{DISTANCES}"]
        for signals, columns in {
            "Setpoint (V)\tDefl (nm)": "extension um, Defl = deflection nm",
            "Setpoint (V)\tLoad (nN)": "position um, Load = force nN",
            "Deflection (nm)\tForce (nN)": "extension um, Force = force nN, "
            "Deflection = deflection nm",
        }.items()
    },
    # It would be added where it has to be subtracted.
    "deflection: falls as the force grows": [both("height", k=-0.05)],
}
"""Tables, some with columns, by what the message says."""


@pytest.mark.parametrize(
    ("message", "table"), [(message, table) for message, them in REFUSED.items() for table in them]
)
def test_tables_that_are_refused(
    tmp_path: Path, message: str, table: str | tuple[str, str]
) -> None:
    """No column is guessed, taken for another or left out in silence."""
    text, columns = (table, None) if isinstance(table, str) else table
    (tmp_path / "a.txt").write_text(text, encoding="utf-8")
    with pytest.raises(pl.ConfigError, match=message):
        curves(tmp_path / "a.txt", columns)


@pytest.mark.parametrize("columns", [None, BY_NUMBER])
def test_signs_of_other_countries(tmp_path: Path, columns: str | None) -> None:
    """Commas between blanks are decimal, and a typographer's minus is one."""
    lines = [f"{-z:.4f} {f:.4f}" for z, f in zip(Z, F, strict=True)]
    text = "\n".join(lines if columns else ["position [um] force [nN]", *lines])
    path = tmp_path / "a.txt"
    for other in (text.replace(".", ","), text.replace("-", "\N{MINUS SIGN}")):
        path.write_text(other, encoding="utf-8")
        assert curves(path, columns)[""].position == pytest.approx(-1e-6 * Z)


def test_rows_without_a_number_are_counted(tmp_path: Path) -> None:
    """A curve without any number says how many rows hold none."""
    path = tmp_path / "a.csv"
    path.write_text("position [um],force [nN]\n" + "1.5D0,2.5D0\n" * 9, encoding="utf-8")
    with pytest.raises(pl.ConfigError, match="without 8 rows that hold no finite number"):
        clean(curves(path)[""])


def test_list_of_files_without_numbers(tmp_path: Path) -> None:
    """Its rows are not those of units, which have no number either."""
    for name in "ab":
        (tmp_path / f"{name}.csv").write_text(f"position [um],force [nN]\n{rows()}")
    (tmp_path / "list.csv").write_text("file,day\na.csv,Monday\nb.csv,Tuesday\n")
    assert [Path(name).stem for name in pl.read_curves(tmp_path / "list.csv")] == ["a", "b"]


PREAMBLES = (
    "File Name: bead1",
    "File\tbead1.dat",
    "File\tsound.txt",
    '"\\*Force file list"',
    "Source,file,7",
    "file",
    "file,day\nsound.txt,Monday",
)


@pytest.mark.parametrize("columns", [None, "position = position, force = force nN"])
@pytest.mark.parametrize("preamble", PREAMBLES)
def test_a_preamble_with_the_word_file(tmp_path: Path, preamble: str, columns: str | None) -> None:
    """It makes no list of files of the table below it, alone or in a folder, whatever it names."""
    for name, line in (("a.txt", preamble), ("sound.txt", "Filename: bead1")):
        text = f"{line}\nOperator: nobody\nposition [um]\tforce [nN]\n{rows(chr(9))}"
        (tmp_path / name).write_text(text)
    for path, count in ((tmp_path / "a.txt", 1), (tmp_path, 2)):
        read_curves = pl.read_curves(path, columns=columns)
        assert [*map(is_the_curve, read_curves.values())] == [True] * count


def test_folders_and_patterns_in_a_list_of_files(tmp_path: Path) -> None:
    """Each of their files has the fields of the row; files of one maker share tip and spring."""
    for name in ("tips/a.csv", "tips/b.csv", "beads/c.csv", "beads/[d].csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(f"position [um],force [nN]\n{rows()}")
    path = tmp_path / "list.csv"
    for listed in ("tips,1\nbeads,5", "tips/*,1\nbeads/c*,5\nbeads/[d].csv,5"):
        path.write_text(f"file,radius [um]\n{listed}\n")
        sources = [*gather(path, Calibration(), {})]
        assert [Path(one.file).stem for one in sources[:2]] == ["a", "b"]
        assert {Path(one.file).stem for one in sources[2:]} == {"c", "[d]"}
        assert [one.fields["radius"] for one in sources] == ["1 um", "1 um", "5 um", "5 um"]
        for one in sources:
            assert isinstance(one.curve, Measurement)
            assert is_the_curve(one.curve)
    path.write_text("file,radius [um]\ntips,1\nlost/*.csv,5\n")
    with pytest.raises(pl.ConfigError, match=r"lost/\*.csv: matches no file"):
        pl.read_curves(path)
    path.unlink()
    with pytest.raises(pl.ConfigError, match=r"of a known kind \(.*\); give its folders, .*/\*$"):
        pl.read_curves(tmp_path)


def test_lists_of_files(tmp_path: Path) -> None:
    """What is missing is named; a table of curves is none, and neither is one with columns."""
    (tmp_path / "a b.csv").write_text(f"position [um],force [nN]\n{rows()}")
    (tmp_path / "list.csv").write_text("# of Monday\nfile\na b.csv\n")
    assert [Path(name).stem for name in pl.read_curves(tmp_path / "list.csv")] == ["a b"]
    (tmp_path / "list.csv").write_text("file,radius [um]\nlost.csv,5\nmislaid.csv,5\n")
    with pytest.raises(pl.ConfigError, match=r"lost.csv: cannot be read(.|\n)*mislaid.csv: cannot"):
        pl.read_curves(tmp_path / "list.csv")
    path, header = tmp_path / "z.txt", "file,position [um],force [nN]"
    path.write_text("\n".join([header, *(f"a b.csv,{row}" for row in rows().split())]))
    for text, columns in (
        (header, None),
        (header, "position = position, force = force"),
        ("file,Z [um],F [nN]", "Z = position, F = force"),
    ):
        path.write_text(path.read_text().replace(header, text))
        (curve,) = pl.read_curves(path, columns=columns).values()
        assert is_the_curve(curve)
    (tmp_path / "a b.csv").write_text(rows())
    (tmp_path / "list.csv").write_text("file,day\na b.csv,Monday\n")
    (curve,) = pl.read_curves(tmp_path / "list.csv", columns=BY_NUMBER).values()
    assert is_the_curve(curve)


STATED = (
    "# Spring constant: 0.05 N/m",
    "Spring Constant (pN/nm);50",
    "cantilever spring constant [N/m] = 0,05",
    "# spring_constant: 5e-2 N/m\n# Deflection sensitivity (nm/V): 100",
    "% k 0.05 nN/nm\n% InvOLS: 100 nm/V",
)


@pytest.mark.parametrize("preamble", STATED)
def test_constants_above_a_table(tmp_path: Path, preamble: str) -> None:
    """Lines above a table state them with their units; without a unit they are not believed."""
    path, volts = tmp_path / "a.csv", "nm/V" in preamble
    signal = F / 5 if volts else 20 * F
    lines = [f"{z + 20e-3 * f}\t{d}" for z, f, d in zip(Z, F, signal, strict=True)]
    table = f"extension [um]\tdeflection [{'V' if volts else 'nm'}]\n" + "\n".join(lines)
    path.write_text(f"{preamble}\n{table}")
    assert is_the_curve(curves(path)[""])
    (changed,) = curves(path, spring_constant="0.1 N/m").values()
    np.testing.assert_allclose(changed.position, 1e-6 * Z)
    np.testing.assert_allclose(changed.force, 2e-9 * F)
    path.write_text(f"# spring constant: 0.05\n# sensitivity: 100\n{table}")
    with pytest.raises(pl.ConfigError, match="missing: spring_constant"):
        curves(path)


@pytest.mark.parametrize("place", ["position", "height"])
@pytest.mark.parametrize(
    ("deflection", "options"),
    [("deflection [nm]", {}), ("deflection [V]", {"sensitivity": "100 nm/V"})],
)
def test_a_spring_constant_that_contradicts_columns(
    tmp_path: Path, place: str, deflection: str, options: dict[str, str]
) -> None:
    """Force over deflection is the file's own; one that is given scales the force, and is told."""
    path = tmp_path / "a.csv"
    path.write_text(both(place, deflection))
    own = curves(path, **options)[""]
    same = curves(path, spring_constant="0.05 N/m", **options)[""]
    assert same.stiffness == 0.05
    assert "scaled" not in str(same.messages)
    changed = curves(path, spring_constant="0.1 N/m", **options)[""]
    np.testing.assert_allclose(changed.force, 2 * own.force)
    np.testing.assert_allclose(changed.position, own.position)
    assert changed.stiffness == 0.1
    assert "in place of the file's 50 mN/m: the force is scaled by 2" in str(changed.messages)
    path.write_text(f"# spring constant: 0.06 N/m\n{both(place, deflection)}")
    with pytest.raises(pl.ConfigError, match="states 60 mN/m, and its force is 50 mN/m times"):
        curves(path, **options)
    chosen = curves(path, spring_constant="0.05 N/m", **options)[""]
    np.testing.assert_allclose(chosen.force, own.force)


def test_a_spring_constant_in_a_column(tmp_path: Path) -> None:
    """It is that of the file if all rows have it."""
    path = tmp_path / "a.csv"
    lines = [f"{z + 20e-3 * f},{20 * f},0.05" for z, f in zip(Z, F, strict=True)]
    path.write_text("extension [um],deflection [nm],k [N/m]\n" + "\n".join(lines))
    assert is_the_curve(curves(path)[""])
    assert "scaled by 2" in str(curves(path, spring_constant="0.1 N/m")[""].messages)
    path.write_text("extension [um],deflection [nm],k [N/m]\n" + "\n".join(lines) + "1")
    with pytest.raises(pl.ConfigError, match="missing: spring_constant"):
        curves(path)


def test_a_unit_that_contradicts_the_header(tmp_path: Path) -> None:
    """It is refused, in tables and in trees; one that is the same, or left out, is not."""
    path = tmp_path / "a.csv"
    path.write_text(f"Z [um],F [nN]\n{rows()}")
    for same in ("Z = position um, F = force nN", "Z = position µm, F = force"):
        assert is_the_curve(curves(path, same)[""])
    for wrong in ("Z = position nm, F = force", "Z = position um, F = deflection mV"):
        with pytest.raises(pl.ConfigError, match=r"by its header, and .* leave the unit out"):
            curves(path, wrong)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["z"], file["f"] = Z, F
        file["z"].attrs["units"] = "um"
    assert is_the_curve(curves(tmp_path / "a.h5", "z = position, f = force nN")[""])
    with pytest.raises(pl.ConfigError, match="'z' is in um by its header, and nm was given"):
        curves(tmp_path / "a.h5", "z = position nm, f = force nN")


def _calls(function: Callable[[], object]) -> int:
    """Return the number of calls of functions in a call that raises an error of its input."""
    count = 0

    def counted(frame: object, event: str, argument: object) -> None:
        nonlocal count
        count += event.endswith("call")

    sys.setprofile(counted)
    try:
        with suppress(pl.PellicleError):
            function()
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.parametrize("head", ["", "# {}"])
def test_a_matrix_among_curves(tmp_path: Path, head: str) -> None:
    """It is told apart, and what its columns are is guessed in a time linear in their number."""
    counts = []
    for size in (100, 200):
        path = tmp_path / f"{size}.txt"
        header = head.format(" ".join(f"name{number}" for number in range(size)))
        np.savetxt(path, np.ones((9, size)), header=header, comments="")
        counts.append(_calls(partial(read_first, path)))
    assert counts[1] < 2.5 * counts[0]
    with pytest.raises(pl.ConfigError) as raised:
        read_first(path)
    told = str(raised.value)
    assert ("has 200 columns without names, as a matrix of heights" in told) == (not head)
    assert ("sensitivity" in told) == bool(head)


def read_first(path: Path) -> Measurement:
    """Return the first curve of a file."""
    return next(iter(read(path).values()))()


def test_one_message_for_each_kind_of_header(tmp_path: Path) -> None:
    """Of files with the same columns, and of curves of a file, it is asked once."""
    for number in range(3):
        (tmp_path / f"{number}.txt").write_text(f"Zsnsr [um]\tDefl [V]\n{rows(chr(9))}")
        with h5py.File(tmp_path / "tree.h5", "a") as file:
            file[f"{number}/height"], file[f"{number}/force"] = Z, F
    table = pl.fit_many(tmp_path, indenter="sphere", radius="5 um", progress=False)
    statuses = {*table["status"].values.tolist()}
    assert len(statuses) == 2
    assert not any("install" in status for status in statuses)


@pytest.mark.parametrize(
    ("header", "times", "seen"),
    [
        ("time [ms]", "1 2 3 4", [1e-3, 2e-3, 3e-3, 4e-3]),
        ("time [s]", "1 2 3 4", [1, 2, 3, 4]),
        ("t [m]", "1 2 3 4", None),
    ],
)
def test_time(tmp_path: Path, header: str, times: str, seen: list[float] | None) -> None:
    """A time that grows is kept; one of no known name is not read."""
    path = tmp_path / "a.csv"
    lines = [f"{line},{time}" for line, time in zip(rows().split(), times.split(), strict=True)]
    path.write_text(f"position [um],force [nN],{header}\n" + "\n".join(lines), encoding="utf-8")
    time = curves(path)[""].time
    assert time is None if seen is None else time == pytest.approx(seen)


@pytest.mark.parametrize("time", [np.ones(9), -np.arange(9.0), np.append(np.arange(8), np.inf)])
def test_a_time_that_does_not_serve(time: Array) -> None:
    """It is left out with a warning; of one without a unit the unit is asked for."""
    curve = clean(Measurement(np.arange(9.0), np.arange(9.0), time=time))
    assert curve.time is None
    assert [text for text in curve.messages if "as one without time" in text]


def test_a_curve_is_drawn_in_the_units_of_its_labels() -> None:
    """Micrometres against nanonewtons: no factor of 1000 is lost."""
    rows = np.array([[-1.0, 0.0], [0.5, 2.0], [2.0, 7.0]])
    axes = Measurement(1e-6 * rows[:, 0], 1e-9 * rows[:, 1]).plot(Figure().subplots())
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("position [µm]", "force [nN]")
    np.testing.assert_allclose(np.asarray(axes.lines[0].get_xydata(), float), rows)


EXPORTS = {
    "Piezo height [um],Deflection [V]": "Piezo height = height um, Deflection = deflection V",
    "Z (nm);Defl_nm": "Z = extension nm, Defl_nm = deflection nm",
    "ZSnsr (nm)\tDefl (nm)\tTime (s)": "ZSnsr = extension nm, Defl = deflection nm, Time = time s",
    "Ramp_nm\tDefl_pN_Ex\tDefl_V_Ex": "Ramp_nm = extension nm, Defl_pN_Ex = force pN",
    "Z-Axis [um];Deflection [nN]": "Z-Axis = extension um, Deflection = force nN",
    "Z (um);Load (nN);Bending (nm)": "Z = extension um, Load = force nN",
    "k: 7\n\nZ (um);Load (nN);Load (nN)": "Z = position um, 2 = force nN",
    "# columns: height vDeflection t": "height = height <unit>, vDeflection = deflection <unit>",
    "a,F [nN]": "<column> = height <unit>, F = force nN",
    "height [m],deflection [V]": "",
}


@pytest.mark.parametrize("header", EXPORTS)
def test_one_message_asks_for_all_that_an_export_lacks(tmp_path: Path, header: str) -> None:
    """It ends with options, which read the curve once they have values."""
    expected, path, head = EXPORTS[header], tmp_path / "export.txt", header.split("\n")[-1]
    mark = next((mark for mark in "\t;," if mark in head), " ")
    sign = -1 if "height" in header + expected else 1
    count = len(head.removeprefix("# columns: ").split(mark))
    lines = [mark.join(map(str, (sign * z, f, f)[:count])) for z, f in zip(Z, F, strict=True)]
    path.write_text("\n".join([header, *lines]), encoding="utf-8")
    config = pl.FitConfig.merged(curves=[path], indenter="sphere")
    with pytest.raises(pl.ConfigError, match="missing: ") as raised:
        config.indenter_of(next(config.sources()))
    _, typed = str(raised.value).split("\n")
    assert typed.endswith('--radius "… um"')
    given = dict(re.findall(r'--(\S+) "([^"]*)"', typed))
    assert given.get("columns", "") == expected
    for blank, value in {"… N/m": "0.1 N/m", "… nm/V": "1 nm/V", "… um": "5 um"}.items():
        given = {name.replace("-", "_"): text.replace(blank, value) for name, text in given.items()}
    if expected:
        text = expected.replace("height <unit>", "height m").replace("<unit>", "V")
        given["columns"] = text.replace("<column>", "a")
    config = pl.FitConfig.merged(config, **given)
    (source,) = config.sources()
    assert isinstance(source.curve, Measurement)
    assert np.all(np.diff(source.curve.position) > 0)
    assert config.indenter_of(source) == pl.indenter("sphere", radius="5 um")


def _asylum(path: Path) -> str:
    with h5py.File(path, "w") as file:
        for number in range(2):
            group = file.create_group(f"ForceMap/Segments/{number}")
            group["ZSnsr"], group["Defl"] = 1e-6 * Z, 1e-9 * F
            group["ZSnsr"].attrs["unit"] = "m"
        file["ForceMap/Segments/broken"] = h5py.SoftLink("/nowhere")
    return "ForceMap/Segments/*/ZSnsr = position, ForceMap/Segments/*/Defl = force N"


def _bruker(path: Path) -> str:
    with h5py.File(path, "w") as file:
        file["Z"], file["data/F"] = Z, np.tile(F, (2, 1))
    return "/Z = position um, data/F = force nN"


@pytest.mark.parametrize("write", [_asylum, _bruker])
def test_hdf5_by_path(tmp_path: Path, write: Callable[[Path], str]) -> None:
    """Arrays anywhere in a file are named by their paths; * stands for each of several groups."""
    path = tmp_path / "converted.h5"
    both = curves(path, write(path))
    assert len(both) == 2
    assert all(map(is_the_curve, both.values()))


@pytest.mark.parametrize("kind", ["virtual", "external", "scale_factor", "add_offset"])
def test_numbers_that_are_not_those_of_the_file_are_refused(tmp_path: Path, kind: str) -> None:
    """Of another file, which no hash covers, or packed as NetCDF packs them."""
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["position"] = Z
        if kind == "virtual":
            layout = h5py.VirtualLayout(F.shape, F.dtype)
            layout[:] = h5py.VirtualSource(tmp_path / "b.h5", "force", F.shape)
            file.create_virtual_dataset("force", layout)
        elif kind == "external":
            file.create_dataset("force", F.shape, F.dtype, external=tmp_path / "b.raw")
        else:
            file["force"] = F
            file["force"].attrs[kind] = 0.5
    with pytest.raises(pl.ConfigError, match=r"a\.h5: (takes|has) force (from other|packed)"):
        curves(path, "position = position um, force = force nN")


def test_what_an_attribute_says_of_numbers(tmp_path: Path) -> None:
    """A unit may be an array of one, and a number stands for missing ones."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["position"], file["force"] = Z, np.where(Z == 3.5, -32768.0, F)
        file["position"].attrs["units"] = np.array([b"um"])
        file["force"].attrs["units"] = "nN"
        file["force"].attrs["_FillValue"] = np.array([-32768.0])
    curve = curves(tmp_path / "a.h5")[""]
    assert is_the_curve(replace(curve, force=np.where(Z == 3.5, 1e-9 * F, curve.force)))
    assert np.array_equal(np.isnan(curve.force), Z == 3.5)


def test_paths_that_lead_nowhere(tmp_path: Path) -> None:
    """A wrong path is refused with a few of the right ones."""
    path = tmp_path / "map.h5"
    with h5py.File(path, "w") as file:
        for number in range(30):
            group = file.create_group(f"curve{number:04d}")
            group["z"], group["f"] = Z, F
    with pytest.raises(pl.ConfigError, match=r"has 'curve0000/f',.*one column 'z', one column 'f'"):
        curves(path, "z = position um, f = force nN")
    with pytest.raises(pl.ConfigError, match="--columns"):
        curves(path)
    # A curve that lacks an array fails alone.
    with h5py.File(path, "r+") as file:
        del file["curve0003/f"]
    readers = read(path, Calibration(columns="*/z = position um, */f = force nN"))
    assert is_the_curve(readers["curve0004"]())
    with pytest.raises(pl.ConfigError, match=r"curve curve0003: has .*; missing: a force"):
        readers["curve0003"]()


PAIR = {"z": Z, "f": F}
VARIABLES: dict[str, tuple[dict[str, Any], str, int]] = {
    "plain": ({"z": Z[:, None], "f": F}, "z = position um, f = force nN", 1),
    "structure": (
        {"data": {"raw": PAIR, "who": "me"}},
        "data.raw.z = position um, data.raw.f = force nN",
        1,
    ),
    "cells": (
        {"curves": np.array([PAIR, PAIR], dtype=object)},
        "curves/*/z = position um, curves/*/f = force nN",
        2,
    ),
    "matrix": ({"z": Z, "f": np.column_stack([F, F])}, "z = position um, f = force nN", 2),
    "new": ({}, "z = position um, f/* = force nN", 2),
}
"""Of files of MATLAB, with how they are read and how many curves that is."""


def _new_mat(path: Path) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        # MATLAB stores columns of cells as references to arrays with reversed axes.
        cells = file.create_group("#refs#")
        cells["a"], cells["b"] = F[None], F[None]
        file["z"] = Z[None]
        references = np.array([[cells["a"].ref, cells["b"].ref]], dtype=h5py.ref_dtype)
        file.create_dataset("f", data=references, dtype=h5py.ref_dtype)


@pytest.mark.parametrize(("variables", "columns", "count"), VARIABLES.values(), ids=VARIABLES)
def test_matlab(tmp_path: Path, variables: dict[str, Any], columns: str, count: int) -> None:
    """Variables, structures, cells and matrices of curves are read, from old files and new."""
    path = tmp_path / "measured.mat"
    savemat(path, variables) if variables else _new_mat(path)
    read_curves = curves(path, columns)
    assert len(read_curves) == count
    assert all(map(is_the_curve, read_curves.values()))
    with pytest.raises(pl.ConfigError, match="; missing: a position"):
        curves(path)


def _ramp(pause: str, noise: float) -> tuple[Array, Array]:
    """Return position [m] and force [N] of an approach, a pause and a retract."""
    up = np.linspace(0, 3e-6, 400)
    rest = np.full(300, up[-1])
    if pause == "creep":
        rest += np.linspace(0, 1e-7, rest.size)
    position = np.concatenate([up, rest, rest[-1] * np.linspace(1, 0, 400)])
    position += noise * np.random.default_rng(0).standard_normal(position.size)
    depth = np.clip(position - 1e-6, 0, None)
    force = 1e3 * depth**1.5
    force[400:700] *= np.linspace(1, 0.7, 300)
    force[700:] *= 0.7
    return position, force


@pytest.mark.parametrize(("pause", "noise"), [("hold", 0.0), ("hold", 2e-9), ("creep", 1e-9)])
def test_pauses_are_left_out(pause: str, noise: float) -> None:
    """Approach and retract end where the pause between them begins and ends."""
    position, force = _ramp(pause, noise)
    approach = clean(Measurement(position, force))
    assert approach.position.size == pytest.approx(400, abs=10)
    assert any("are the approach" in text for text in approach.messages)
    retract = clean(Measurement(position, force), "retract")
    assert retract.position.size == pytest.approx(400, abs=10)
    assert retract.position[0] > retract.position[-1]
    # Without a retract, the pause ends the file.
    alone = clean(Measurement(position[:700], force[:700]))
    assert alone.position.size == pytest.approx(400, abs=10)


@pytest.mark.parametrize("every", [1, 5])
@pytest.mark.parametrize(("pause", "noise"), [("hold", 0.0), ("hold", 2e-9), ("creep", 1e-9)])
def test_rows_of_unloading(pause: str, noise: float, every: int) -> None:
    """A pause is part of the loading, of many rows or of few."""
    position, force = (values[::every] for values in _ramp(pause, noise))
    both = clean(Measurement(position, force), "both")
    assert both.unloading is not None
    assert np.all(np.diff(both.unloading.astype(int)) >= 0)
    assert both.unloading.sum() == pytest.approx(400 / every, abs=10 / every)
    assert not np.any(clean(Measurement(position, force)).unloading)
    assert np.all(clean(Measurement(position, force), "retract").unloading)


@pytest.mark.parametrize("motion", ["triangle", "sine"])
def test_a_pass_without_a_pause_is_whole(motion: str) -> None:
    """A steady motion loses no row, and neither does one that slows down as a sine."""
    share = np.linspace(0, 1, 400)
    depth = 3e-6 * (share if motion == "triangle" else (1 - np.cos(np.pi * share)) / 2) - 1e-6
    assert clean(Measurement(depth, np.clip(depth, 0, None) ** 1.5)).position.size == 400
