"""Curves in the formats of instruments, and tables of what a cantilever sees."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import pellicle as pl
from pellicle_fit.files.cleaning import clean
from pellicle_fit.files.columns import Calibration
from pellicle_fit.files.measurement import Measurement, Segment
from pellicle_fit.files.readers import read
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.plugins.fit import instruments
from tests.plugins.fit.conftest import holds

pytestmark = pytest.mark.usefixtures("no_rivals")

Array = NDArray[np.float64]
MODULUS, LENGTH, RADIUS, SPRING, SENSITIVITY = 5e3, 3e-6, 10e-6, 0.05, 50e-9
GIVEN = Calibration(spring_constant=SPRING, sensitivity=SENSITIVITY)
BEAD = Paraboloid(radius=RADIUS)


POSITION = np.linspace(-1e-6, 3e-6, 300)
FORCE = MODULUS * BEAD.force_curve(POSITION, LENGTH).force
NOISE = 0.005 * FORCE.max() * np.random.default_rng(4).standard_normal(FORCE.size)
SEEN = POSITION - NOISE / SPRING, FORCE + NOISE
"""Position and force that are to be read: noise of the deflection is in both."""


@pytest.fixture(scope="module")
def recording() -> instruments.Recording:
    """Return what an instrument sees of the curve."""
    return instruments.record(POSITION, FORCE, NOISE, SPRING)


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
def test_formats(tmp_path: Path, recording: instruments.Recording, name: str) -> None:
    """Approach and retract are told apart, and the bending of the cantilever is subtracted."""
    path = tmp_path / name
    instruments.WRITERS[name](path, recording)
    calibration = GIVEN if name == "workshop.csv" else None
    position, force = SEEN
    approach, retract = (only(path, calibration, one) for one in ("approach", "retract"))
    assert retract.position[0] - retract.position[-1] == pytest.approx(np.ptp(position), rel=0.03)
    assert is_curve(approach, position, force)


@pytest.mark.parametrize("name", instruments.MAPS)
def test_maps(tmp_path: Path, recording: instruments.Recording, name: str) -> None:
    """A file of several curves has each by its number."""
    instruments.MAPS[name](tmp_path / name, [recording, recording])
    curves = read(tmp_path / name)
    assert list(curves) == ["0", "1"]
    assert all(is_curve(clean(reader()), *SEEN) for reader in curves.values())


def test_calibration_is_asked_for(tmp_path: Path, recording: instruments.Recording) -> None:
    """A signal in volts needs spring constant and sensitivity, and the message says so."""
    instruments.workshop(tmp_path / "workshop.csv", recording)
    with pytest.raises(pl.ConfigError, match='--sensitivity "… nm/V" --spring-constant "… N/m"'):
        read(tmp_path / "workshop.csv")


def test_damaged_file(tmp_path: Path, recording: instruments.Recording) -> None:
    """A file that was cut off is said to be unreadable."""
    path = tmp_path / "curve.jpk-force"
    instruments.jpk(path, recording)
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(pl.StorageError, match="afmformats cannot read it"):
        read(path)


@pytest.mark.parametrize("name", ["curve.jpk-force", "export.h5"])
def test_without_the_extra(
    tmp_path: Path,
    recording: instruments.Recording,
    monkeypatch: pytest.MonkeyPatch,
    name: str,
) -> None:
    """Where afmformats is not installed, the message says how to get it."""
    instruments.WRITERS[name](tmp_path / name, recording)
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
