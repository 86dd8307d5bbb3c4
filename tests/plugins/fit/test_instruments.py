"""Curves in the formats of instruments, and tables of what a cantilever sees."""

import sys
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle_fit.files.choice import read
from pellicle_fit.files.cleaning import clean
from pellicle_fit.files.columns import Calibration
from pellicle_fit.files.measurement import Measurement, Segment
from pellicle_fit.files.reader import DRIVEN, Reader
from pellicle_fit.testing import check_reader
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.plugins.fit import instruments
from tests.plugins.fit.conftest import holds

pytestmark = pytest.mark.usefixtures("no_rivals")

MODULUS, LENGTH, RADIUS, SPRING, SENSITIVITY = 5e3, 3e-6, 10e-6, 0.05, 50e-9
GIVEN = Calibration(spring_constant=SPRING, sensitivity=SENSITIVITY)
BEAD = Paraboloid(radius=RADIUS)


POSITION = np.linspace(-1e-6, 3e-6, 300)
FORCE = MODULUS * BEAD.force_curve(POSITION, LENGTH).force
NOISE = 0.005 * FORCE.max() * np.random.default_rng(4).standard_normal(FORCE.size)
SEEN = POSITION - NOISE / SPRING, FORCE + NOISE
"""Position and force that are to be read: noise of the deflection is in both."""


RECORDING = instruments.record(POSITION, FORCE, NOISE, SPRING)
"""What an instrument sees of the curve."""


def only(
    path: Path, calibration: Calibration | None = None, segment: Segment = "approach"
) -> Measurement:
    """Return a pass of the only curve of a file."""
    (reader,) = read(path, calibration).values()
    return clean(reader(), segment)


def is_curve(measured: Measurement, position: Array, force: Array) -> bool:
    """Whether a curve is this one, but for where position is 0."""
    moved = measured.position - position
    same = np.ptp(moved) < 1e-6 * np.ptp(position)
    return bool(same and np.allclose(measured.force, force, atol=1e-6 * np.ptp(force)))


@pytest.mark.parametrize("name", instruments.WRITERS)
def test_formats(tmp_path: Path, name: str) -> None:
    """Approach and retract are told apart, and the bending of the cantilever is subtracted."""
    path = tmp_path / name
    instruments.WRITERS[name](path, RECORDING)
    calibration = GIVEN if name == "workshop.csv" else None
    position, force = SEEN
    approach, retract = (only(path, calibration, one) for one in ("approach", "retract"))
    assert retract.position[0] - retract.position[-1] == pytest.approx(np.ptp(position), rel=0.03)
    assert is_curve(approach, position, force)


@pytest.mark.parametrize("name", instruments.MAPS)
def test_maps(tmp_path: Path, name: str) -> None:
    """A file of several curves has each by its number."""
    instruments.MAPS[name](tmp_path / name, [RECORDING, RECORDING])
    curves = read(tmp_path / name)
    assert list(curves) == ["0", "1"]
    assert all(is_curve(clean(reader()), *SEEN) for reader in curves.values())


def test_calibration_is_asked_for(tmp_path: Path) -> None:
    """A signal in volts needs spring constant and sensitivity, and the message says so."""
    instruments.workshop(tmp_path / "workshop.csv", RECORDING)
    with pytest.raises(pl.ConfigError, match='--sensitivity "… nm/V" --spring-constant "… N/m"'):
        read(tmp_path / "workshop.csv")


@pytest.mark.parametrize("name", instruments.WRITERS)
def test_another_spring_constant_scales_the_force(tmp_path: Path, name: str) -> None:
    """The deflection, and so the position of the tip, is what was measured; the record tells it."""
    path, new = tmp_path / name, 1.2 * SPRING
    instruments.WRITERS[name](path, RECORDING)
    if name == "workshop.csv":
        # It states no constants, which its loader needs.
        (curve,) = (reader() for reader in read(path, GIVEN).values())
        assert curve.origin.sensitivity == SENSITIVITY
        return
    (curve,), (changed,) = (
        [reader() for reader in read(path, Calibration(spring_constant=k)).values()]
        for k in (None, new)
    )
    assert curve.stiffness == pytest.approx(SPRING)
    assert changed.stiffness == new
    np.testing.assert_allclose(changed.position, curve.position)
    np.testing.assert_allclose(changed.force, 1.2 * curve.force)
    (text,) = set(changed.messages) - set(curve.messages)
    assert "60 mN/m in place of the file's 50 mN/m: the force is scaled by 1.2" in text
    if name not in ("curve.jpk-force", "curve.000", "curve.spm"):
        with pytest.raises(pl.ConfigError, match="sensitivity: is not used"):
            [reader() for reader in read(path, GIVEN).values()]


@pytest.mark.parametrize("sensitivity", ["61 m/A", "61 nm/nA", "0.061 um/nA"])
def test_nova(tmp_path: Path, sensitivity: str) -> None:
    """Columns without names are taken for NT-MDT's with a warning; its signal is a current."""
    path = tmp_path / "nova.txt"
    options: dict[str, Any] = {"spring_constant": SPRING}
    instruments.nova(path, RECORDING, 61.0)
    with pytest.raises(pl.ConfigError, match=r'NT-MDT.*missing: (.|\n)*--sensitivity "… nm/nA"'):
        only(path)
    for wrong in ("61 nm/V", "61 m/V", 61.0):
        with pytest.raises(pl.ConfigError, match="signal in volts, and this one is in A"):
            only(path, Calibration(sensitivity=wrong, **options))
    config = pl.FitConfig.merged(curves=[path], indenter=BEAD, sensitivity=sensitivity, **options)
    again = pl.FitConfig.merged(config.to_dict() | {"curves": [path], "indenter": BEAD})
    for one in (config, again):
        (source,) = one.sources()
        assert isinstance(source.curve, Measurement)
        assert is_curve(clean(source.curve), *SEEN)
        assert [text for text in source.curve.messages if "three columns without names" in text]
    (tmp_path / "commas.txt").write_text(path.read_text().replace("\t", ","))
    with pytest.raises(pl.ConfigError, match="has '1', '2', '3'; missing: a position"):
        read(tmp_path / "commas.txt", Calibration(sensitivity=sensitivity, **options))[""]()
    # As a table whose columns are given it is the same, from the deepest row on.
    config = pl.FitConfig.merged(config, columns="1 = height nm, 2 = deflection nA")
    (source,) = config.sources()
    assert isinstance(source.curve, Measurement)
    assert is_curve(clean(source.curve, "retract"), SEEN[0][::-1], SEEN[1][::-1])


NAMED = {
    "Zsnsr [um]\tDefl [V]\ttime [s]": "Zsnsr = extension um, Defl = deflection V, time = time s",
    "a\tb\tc": "<column> = height <unit>, <column> = deflection <unit>",
    "x\tLoad\tDate": "<column> = height <unit>, Load = force <unit>",
}


@pytest.mark.parametrize("mark", ["", "# ", "# columns: "])
@pytest.mark.parametrize("header", NAMED)
def test_a_table_with_names_is_no_instruments(tmp_path: Path, header: str, mark: str) -> None:
    """Of three columns that have names or units, it is asked which they are."""
    path = tmp_path / "a.txt"
    np.savetxt(path, np.arange(27).reshape(9, 3), header=header, comments=mark, delimiter="\t")
    with pytest.raises(pl.ConfigError, match="missing: a position") as raised:
        only(path, GIVEN)
    assert f'--columns "{NAMED[header]}"' in str(raised.value)


def test_curves_of_an_archive(tmp_path: Path) -> None:
    """Curves that share a number are all kept; places may lie on a line; no warning is right."""
    path, given = tmp_path / "a.zip", Calibration(spring_constant=SPRING)
    several = [replace(RECORDING, force=f * RECORDING.force) for f in (1, 2, 3)]
    instruments.archive(path, several, points=[1, 1, 2])
    curves = {label: reader() for label, reader in read(path, given).items()}
    largest = {label: curve.force.max() / RECORDING.force.max() for label, curve in curves.items()}
    assert largest == pytest.approx({"1": 1, "1 (2)": 2, "2": 3})
    instruments.archive(path, [RECORDING] * 11, columns=11)
    curves = {label: reader() for label, reader in read(path, given).items()}
    assert list(curves) == [str(number) for number in range(1, 12)]
    assert [curve.site for curve in curves.values()] == [(1e-6 * n, 0) for n in range(11)]
    assert all(is_curve(clean(curve), *SEEN) for curve in curves.values())


@pytest.mark.parametrize("signal", ["N", "m", "V"])
@pytest.mark.parametrize("heights", ["height", "verticalTipPosition smoothedMeasuredHeight"])
def test_text_exports(tmp_path: Path, signal: str, heights: str) -> None:
    """Two segments in one text are one curve in order of time, in the units that it states."""
    path = tmp_path / "export.txt"
    instruments.jpk_text(path, RECORDING, signal, heights)
    (curve,) = (reader() for reader in read(path).values())
    assert curve.time == pytest.approx(1e-3 * np.arange(600))
    assert is_curve(clean(curve), *SEEN)
    # The signal in volts is converted by a given sensitivity in place of the one stated.
    given = Calibration(sensitivity=2 * SENSITIVITY)
    if signal == "V":
        (changed,) = (reader() for reader in read(path, given).values())
        np.testing.assert_allclose(changed.force, 2 * curve.force)
    text = path.read_text().replace("seriesTime time", "seriesTime other", 1)
    path.write_text(text)
    with pytest.raises(pl.ConfigError, match="its segments differ in columns"):
        read(path)


def test_groups_of_an_export(tmp_path: Path) -> None:
    """Whatever the groups of an export by afmformats are called, and whatever else is there."""
    path = tmp_path / "export.h5"
    instruments.hdf5(path, RECORDING)
    with h5py.File(path, "a") as file:
        file.move("0", "7")
        file.copy("7", "12")
        file.create_group("notes")["by"] = np.arange(3)
        file["lost"] = h5py.SoftLink("/nowhere")
    curves = read(path)
    assert list(curves) == ["7", "12"]
    assert all(is_curve(clean(reader()), *SEEN) for reader in curves.values())


def test_a_damaged_curve_of_an_archive(tmp_path: Path) -> None:
    """It says so by its name, and the others are read."""
    path, given = tmp_path / "a.zip", Calibration(spring_constant=SPRING)
    instruments.archive(path, [RECORDING, RECORDING])
    with zipfile.ZipFile(path) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    first, last = (name for name, text in contents.items() if text.startswith(b"Force-Dist"))
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("damaged.csv", contents[first][:600] + b"\n1,2\n")
        archive.writestr(last, contents[last])
    good, damaged = read(path, given).items()
    assert is_curve(clean(good[1]()), *SEEN)
    assert damaged[0] == "damaged.csv"
    with pytest.raises(pl.StorageError, match="afmformats cannot read it"):
        damaged[1]()


def test_a_file_that_is_replaced_is_read_again(tmp_path: Path) -> None:
    """An archive of JPK stays open in afmformats, which would go on with the old one."""
    path = tmp_path / "curve.jpk-force"
    for factor in (1.0, 2.0):
        new = tmp_path / "new"
        instruments.jpk(new, replace(RECORDING, force=factor * RECORDING.force))
        new.replace(path)
        assert only(path).force == pytest.approx(factor * SEEN[1], abs=1e-6 * np.ptp(SEEN[1]))


@pytest.mark.parametrize("constant", [np.nan, 0.0, -0.05])
def test_a_spring_constant_that_is_none_is_replaced(tmp_path: Path, constant: float) -> None:
    """Exports of curves that were not calibrated hold such numbers: asked for, then read."""
    path = tmp_path / "export.h5"
    instruments.hdf5(path, RECORDING)
    with h5py.File(path, "a") as file:
        file["0"].attrs["spring constant"] = constant
    with pytest.raises(pl.ConfigError, match="missing: spring_constant"):
        only(path)
    assert is_curve(only(path, GIVEN.model_copy(update={"sensitivity": None})), *SEEN)


@pytest.mark.parametrize("name", ["curve.jpk-force", "export.h5"])
def test_without_the_extra(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    name: str,
) -> None:
    """Where afmformats is not installed, the message says how to get it."""
    instruments.WRITERS[name](tmp_path / name, RECORDING)
    monkeypatch.setitem(sys.modules, "afmformats", None)
    with pytest.raises(pl.PellicleError, match=r"pip install 'pellicle\[afm\]'"):
        only(tmp_path / name)


COLUMNS = {
    "height [um],force [nN]": (-1e6, 0.0),
    "height [um],deflection [nm]": (-1e6, 1e9),
    "extension [nm],deflection [mV]": (1e9, 1e3 / SENSITIVITY),
    "extension [nm],deflection [nm],force [nN]": (1e9, 1e9),
}


@pytest.mark.parametrize("header", COLUMNS)
def test_columns_of_a_cantilever(tmp_path: Path, header: str) -> None:
    """Height or extension, less the deflection, is the position; force is its spring's."""
    position, force = SEEN
    bending = force / SPRING
    place, signal = COLUMNS[header]
    values = {"deflection": bending * signal, "force": force * 1e9}
    names = [column.split()[0] for column in header.split(",")]
    rows = np.column_stack([(position + bending) * place, *(values[name] for name in names[1:])])
    path = tmp_path / "curve.csv"
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.12g")
    assert is_curve(only(path, GIVEN), position, force)
    if header != "extension [nm],deflection [nm],force [nN]":
        with pytest.raises(pl.ConfigError, match=r"spring_constant|sensitivity"):
            only(path)
    else:
        assert is_curve(only(path), position, force)


def test_noise_of_the_deflection_is_in_the_position_too() -> None:
    """With a spring as soft as the contact, a fit that knows it holds the truth; others say so."""
    fit = pl.fit(*SEEN, indenter=BEAD, spring_constant=SPRING)
    assert not fit.warnings
    assert holds(fit.reduced_modulus, MODULUS)
    assert holds(fit.tension, MODULUS * LENGTH / 2)
    blind = pl.fit(*SEEN, indenter=BEAD)
    assert blind.warnings


READERS: dict[str, tuple[str, Any]] = {
    "spectrum.nid": ("nanosurf", None),
    "curve.000": ("nanoscope", None),
    "curve.jpk-force": ("jpk", None),
    "export.h5": ("exported", None),
    "export.tab": ("exported_table", None),
    "chiaro.txt": ("chiaro", None),
    "workshop.csv": ("workshop", GIVEN),
    "stated.csv": ("table", None),
}
"""A reader for each of some files, and the calibration that it needs."""


@pytest.mark.parametrize("name", READERS)
def test_readers_keep_their_contract(tmp_path: Path, name: str) -> None:
    """Files are told from others, and cut or damaged ones are errors in words."""
    instruments.WRITERS[name](tmp_path / name, RECORDING)
    type_, given = READERS[name]
    reader = pl.registry().make(Reader, {"type": type_})
    check_reader(reader, tmp_path / name, calibration=given)


def _cut_jpk(path: Path) -> None:
    instruments.jpk(path, RECORDING)
    path.write_bytes(path.read_bytes()[:2000])


FIVE = "extend", "pause", "retract", "pause", "extend"
SPECTRUM = "cannot be read as a spectrum .*"
UNREADABLE: list[tuple[str, Callable[[Path], None], str]] = [
    (
        "a.nid",
        lambda p: instruments.nid(p, RECORDING, cut=9),
        f"{SPECTRUM}it ends within channel D",
    ),
    (
        "a.nid",
        lambda p: instruments.nid(p, RECORDING, bits="64"),
        f"{SPECTRUM}has the layout Binary, Signed, Intel, 64 bits",
    ),
    ("a.nid", lambda p: instruments.nid(p, RECORDING, bits="x"), f"{SPECTRUM}invalid literal"),
    # Force volumes and curves with a hold.
    ("a.spm", lambda p: instruments.nanoscope(p, RECORDING, "FVOL"), "single curves are read"),
    ("a.spm", lambda p: instruments.nanoscope(p, RECORDING, samples=7), "with a hold are not"),
    (
        "a.jpk-force-map",
        lambda p: instruments.jpk(p, RECORDING, RECORDING, styles=FIVE),
        "segments: 5.*export each .* table",
    ),
    (
        "a.jpk-force-map",
        lambda p: instruments.jpk(p, RECORDING, RECORDING, styles=FIVE[:1]),
        "segments: 1.*export each .* table",
    ),
    ("a.jpk-force", _cut_jpk, "afmformats cannot read it"),
]


@pytest.mark.parametrize(("name", "write", "message"), UNREADABLE)
def test_files_that_cannot_be_read(
    tmp_path: Path, name: str, write: Callable[[Path], None], message: str
) -> None:
    """What is wrong with them is said, or what to do instead."""
    write(tmp_path / name)
    with pytest.raises(pl.StorageError, match=message):
        only(tmp_path / name)


def test_absurd_numbers_take_no_memory(tmp_path: Path) -> None:
    """Sizes in a header are compared with the file before anything is read."""
    for name, old, new in (
        ("a.nid", b"Points=300", b"Points=300000000000"),
        ("a.nid", b"Lines=1\r", b"Lines=99999999999\r"),
        ("a.000", b"Samps/line: 300 300", b"Samps/line: 3000000000 3000000000"),
        ("a.000", b"Data length: 2400", b"Data length: 24000000000"),
    ):
        write = instruments.nid if name == "a.nid" else instruments.nanoscope
        write(tmp_path / name, RECORDING)
        content = (tmp_path / name).read_bytes()
        assert old in content
        (tmp_path / name).write_bytes(content.replace(old, new))
        with pytest.raises(pl.StorageError, match="cannot be read as"):
            only(tmp_path / name)


def test_unmeasured_rows_and_units(tmp_path: Path) -> None:
    """The least integer is no row; a sensitivity in another unit than nm/V is refused."""
    path = tmp_path / "a.000"
    instruments.nanoscope(path, RECORDING)
    content = bytearray(path.read_bytes())
    content[4096 + 4 * 299 : 4096 + 4 * 300] = np.array([-(2**31)], "<i4").tobytes()
    path.write_bytes(content)
    (curve,) = (reader() for reader in read(path).values())
    assert curve.force.size == 599
    path.write_bytes(bytes(content).replace(b" nm/V\r", b" pA/V\r"))
    with pytest.raises(pl.StorageError, match="is in pA/V, not in nm/V"):
        only(path)


def test_a_height_that_was_not_measured_is_told(tmp_path: Path) -> None:
    """Piezos without a closed loop miss it by far; with the height of a sensor nothing is told."""
    changes = {
        "curve.000": (b'"Height Sensor"', b'"Weight Sensor"'),
        "spectrum.nid": (b"Dim2Name=Z-Axis Sensor", b"Dim2Name=Z-Axis"),
    }
    for name in ("curve.000", "spectrum.nid", "export.h5"):
        path = tmp_path / name
        instruments.WRITERS[name](path, RECORDING)
        (measured,) = (reader() for reader in read(path).values())
        if name in changes:
            path.write_bytes(path.read_bytes().replace(*changes[name]))
        else:
            with h5py.File(path, "a") as file:
                file.move("0/height (measured)", "0/height (piezo)")
        (driven,) = (reader() for reader in read(path).values())
        assert measured.messages == ()
        assert [*driven.messages] == [DRIVEN]
    path = tmp_path / "curve.000"
    closed = path.read_bytes().replace(b"\r\n\\Forward", b"\r\n\\Z Closed Loop: On\r\n\\Forward")
    path.write_bytes(closed.replace(b"\0" * 20, b"", 1))
    (driven,) = (reader() for reader in read(path).values())
    assert driven.messages == ()


def test_files_of_images_are_passed_over(tmp_path: Path) -> None:
    """In a folder they are no curves; alone they are refused. A table may have their suffix."""
    instruments.nanoscope(tmp_path / "a.000", RECORDING)
    (tmp_path / "b.000").write_bytes(b"\\*File list\r\n" + bytes(99))
    (tmp_path / "c.nid").write_bytes(b"[DataSet]\r\n#!" + bytes(99))
    assert [*pl.read_curves(tmp_path)] == [str(tmp_path / "a.000")]
    for name in ("b.000", "c.nid"):
        with pytest.raises(pl.StorageError, match=r"suffix of force curves .*, and holds none"):
            read(tmp_path / name)
    (tmp_path / "d.000").write_text("position [um],force [nN]\n1,2\n", encoding="utf-8")
    assert list(read(tmp_path / "d.000")) == [""]
