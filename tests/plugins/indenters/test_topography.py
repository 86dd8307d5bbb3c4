"""Measured surfaces.

``patch.gwy`` and ``patch.x3p`` in tests/data hold one surface made of 40 waves with a tilt, of
39 × 33 points on 1.3 mm × 1.1 mm; the second lacks 7 points. They were written by SurfaceTopography
in the formats of Gwyddion and of ISO 25178-72.
"""

from __future__ import annotations

import io
import pickle
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle import memory

DATA = Path(__file__).parents[2] / "data"
GWY, X3P = DATA / "patch.gwy", DATA / "patch.x3p"
GRID = pl.Grid(points=[39, 33], size=["1.3 mm", "1.1 mm"])


def _profile(grid: pl.Grid = GRID, path: Path = GWY, **fields: Any) -> np.ndarray:
    return pl.indenter("topography", path=path, **fields).profile(*grid.coordinates())


def _heights() -> np.ndarray:
    """Return the heights [m] in the .gwy file, which keeps them as doubles after its header."""
    content = GWY.read_bytes()
    start = content.index(b"data\0D", content.index(b"GwyDataField")) + 10
    return np.frombuffer(content[start : start + 8 * 39 * 33], "<f8").reshape(33, 39).T


def test_heights_unit_and_size_are_the_files() -> None:
    """On its own points the profile is what the file holds, in metres, less the highest."""
    expected = _heights() - _heights().max()
    assert np.ptp(expected) == pytest.approx(42.48e-6, rel=1e-3)
    assert _profile(level="none") == pytest.approx(expected, abs=1e-19)


def test_both_formats_agree() -> None:
    """The same surface in two formats is the same, to single precision and but for what is lost."""
    one, two = _profile(level="none"), _profile(path=X3P, level="none", fill=0.01)
    difference = abs(one - two)
    assert np.count_nonzero(difference > 5e-12) <= 7
    # Filled points lie among their neighbours.
    assert difference.max() < 2e-6


def test_levels(tmp_path: Path) -> None:
    """A plane, or a paraboloid, added to the heights is taken away again."""
    x, y = GRID.coordinates()
    plane, bowl = 0.03 * x - 0.01 * y, 10 * x**2 - 30 * x * y + 20 * y**2
    for level, added, left in (
        ("none", plane, plane),
        ("mean", plane, plane),
        ("tilt", plane, 0),
        ("curvature", plane + bowl, 0),
    ):
        before, after = (
            _from_array(tmp_path, _heights() + more, level).profile(x, y) for more in (0, added)
        )
        difference = after - before - left
        assert np.ptp(difference) < 1e-15, level
    # A paraboloid is not level by a plane.
    bowed = _from_array(tmp_path, _heights() + bowl, "tilt").profile(x, y)
    assert np.ptp(bowed - _from_array(tmp_path, _heights(), "tilt").profile(x, y)) > 1e-9


def _from_array(folder: Path, heights: np.ndarray, level: str) -> pl.Indenter:
    """Return the indenter of a file without unit and size."""
    path = folder / "heights.npy"
    np.save(path, heights)
    return pl.indenter("topography", path=path, unit=1, size=["1.3 mm", "1.1 mm"], level=level)


def test_invert_turns_valleys_into_peaks() -> None:
    """Inverted, the lowest point of the scan is what touches first."""
    upright, upside_down = _profile(level="none"), _profile(level="none", invert=True)
    assert upside_down == pytest.approx(upright.min() - upright, abs=1e-19)


def test_domain_is_a_part_of_the_scan() -> None:
    """A smaller domain sees the points under it, about the middle or a point that is given."""
    grid = pl.Grid(points=13, size=13 / 30e3)
    part = _profile(grid, level="none")
    middle = _heights()[13:26, 10:23]
    assert part == pytest.approx(middle - middle.max(), abs=1e-19)
    part = _profile(grid, level="none", centre=[6.5 / 30e3, 20.5 / 30e3])
    corner = _heights()[:13, 14:27]
    assert part == pytest.approx(corner - corner.max(), abs=1e-19)


def test_coarser_grid_samples_the_surface() -> None:
    """A grid three times as coarse has the heights of every third point."""
    grid = pl.Grid(points=[13, 11], size=["1.3 mm", "1.1 mm"])
    assert _profile(grid) == pytest.approx(_profile()[1::3, 1::3], abs=1e-18)


def test_finer_grid_is_warned_about_and_goes_through_the_points() -> None:
    """Three cells to a point keep the heights of the points; a warning says what that means."""
    grid = pl.Grid(points=[117, 99], size=["1.3 mm", "1.1 mm"])
    with pytest.warns(UserWarning, match=r"cells of 1\.11e-05 .* are finer than the points"):
        fine = _profile(grid, level="none")
    assert (fine <= 0).all()
    shift = fine[1::3, 1::3] - _profile(level="none")
    assert np.ptp(shift) < 1e-15


def test_interpolation_is_of_fourth_order(tmp_path: Path) -> None:
    """A wave sampled between its points is met to the fourth order of their distance."""
    errors = []
    for n in (48, 96):
        x, y = pl.Grid(points=n, size=["1.3 mm", "1.1 mm"]).coordinates()
        q = 2 * np.pi / 0.7e-3
        given = 1e-6 * np.cos(q * x + 0.3) * np.cos(q * y)
        grid = pl.Grid(points=n, size=["0.65 mm", "0.55 mm"])
        with pytest.warns(UserWarning, match="finer"):
            found = _from_array(tmp_path, given, "none").profile(*grid.coordinates())
        x, y = grid.coordinates()
        wanted = 1e-6 * np.cos(q * x + 0.3) * np.cos(q * y)
        difference = (found - wanted)[4:-4, 4:-4]
        errors.append(np.ptp(difference))
    assert errors[0] / errors[1] > 12


def test_rough_run_under_tension_converges() -> None:
    """A run from a file, with a tension, converges and touches with the peaks."""
    result = pl.run(
        {
            "grid": {"points": [39, 33], "size": ["1.3 mm", "1.1 mm"], "boundary": "periodic"},
            "kernel": {"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": "20 mN/m"},
            "indenter": {"type": "topography", "path": str(X3P), "fill": 0.01},
            "loading": {"mean_pressure": "30 Pa"},
        },
        progress=False,
    )
    assert result.converged
    data = result.dataset.isel(step=0)
    profile = (data["displacement"] - data["depth"] - data["gap"]).values
    touching = profile[data["contact"].values]
    assert 0 < touching.size < profile.size / 2
    assert touching.mean() > profile.mean() + profile.std()


def test_is_recorded_by_the_hash_of_the_file(tmp_path: Path) -> None:
    """The hash of the file is written down, and a file that has changed is refused."""
    path = tmp_path / "a.gwy"
    path.write_bytes(GWY.read_bytes())
    indenter = pl.indenter("topography", path=path)
    recorded = indenter.model_dump(exclude_none=True)
    copy = pickle.loads(pickle.dumps(indenter))
    assert copy == indenter
    assert np.array_equal(copy.profile(*GRID.coordinates()), _profile())
    changed = bytearray(path.read_bytes())
    changed[-3000] ^= 1
    path.write_bytes(changed)
    with pytest.raises(pl.ConfigError, match=r"^sha256: .*they have changed"):
        pl.indenter(recorded.pop("type"), **recorded)


def _truncated(content: bytes) -> bytes:
    return content[: len(content) // 2]


def _bad_zip(content: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(stream, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            new.writestr(name, data[:100] if name.endswith("data.bin") else data)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("path", "damage"),
    [(GWY, _truncated), (X3P, _truncated), (X3P, _bad_zip), (GWY, lambda content: content[:60])],
)
def test_damaged_files(tmp_path: Path, path: Path, damage: Callable[[bytes], bytes]) -> None:
    """A file that ends too early is said to be damaged, in one line."""
    file = tmp_path / path.name
    file.write_bytes(damage(path.read_bytes()))
    with pytest.raises(pl.ConfigError, match=r"^path: .*damaged") as caught:
        pl.indenter("topography", path=file)
    assert "\n" not in str(caught.value)


def test_unknown_format_lists_what_can_be_read(tmp_path: Path) -> None:
    """A file of no known format is answered with the formats that there are."""
    file = tmp_path / "a.bin"
    file.write_bytes(b"\x01\x02nothing that anybody reads" * 9)
    with pytest.raises(pl.ConfigError, match=r"no format that can be read.*gwy.*x3p"):
        pl.indenter("topography", path=file)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({}, r"^unit: is missing, .* the length that 1 stands for"),
        ({"unit": "1 um"}, r"^size: is missing, .*edge lengths"),
    ],
)
def test_what_a_file_does_not_say_is_asked_for(
    tmp_path: Path, fields: dict[str, Any], message: str
) -> None:
    """Plain numbers have neither unit nor size: both are asked for by the name of the field."""
    np.savetxt(tmp_path / "a.txt", _heights() * 1e6)
    with pytest.raises(pl.ConfigError, match=message):
        pl.indenter("topography", path=tmp_path / "a.txt", **fields)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"unit": "1 um"}, "^unit: .*states its own unit"),
        ({"size": ["1 um", "1 um"]}, r"^size: .*states its own size, 0.0013 × 0.0011 m"),
        ({"channel": "Phase"}, r"^channel: 'Phase' is not in .*: 'Height'"),
        ({"fill": 1}, "^fill: .*< 1"),
        ({"level": "cubic"}, "^level: .*curvature"),
    ],
)
def test_bad_fields(fields: dict[str, Any], message: str) -> None:
    """What contradicts the file, or is not allowed, is named with what is."""
    with pytest.raises(pl.ConfigError, match=message):
        pl.indenter("topography", path=GWY, **fields)


def test_missing_points_are_refused_or_filled() -> None:
    """Missing points are counted under the domain; a share that is stated is filled in."""
    with pytest.raises(pl.ConfigError, match=r"^fill: 0\.54% of the points .* allows 0\.00%"):
        _profile(path=X3P)
    assert np.isfinite(_profile(path=X3P, fill=0.006)).all()
    # Nothing is missing under this part.
    grid = pl.Grid(points=9, size="0.3 mm")
    assert np.isfinite(_profile(grid, path=X3P, centre=["0.8 mm", "0.7 mm"])).all()


@pytest.mark.parametrize(
    ("size", "centre", "message"),
    [
        (
            "1.2 mm",
            None,
            r"^path: the domain reaches along y .* grid\.size at most 0.0011 m",
        ),
        (["1.4 mm", "0.6 mm"], None, r"along x .* at most 0.0013 m along x"),
        ("0.3 mm", ["0.1 mm", "0.3 mm"], r"^centre: .* at most 0.0002 m along x, or move centre"),
    ],
)
def test_domain_that_does_not_fit_the_scan(size: object, centre: object, message: str) -> None:
    """A domain beyond the scan, or of less than two of its points, is refused with numbers."""
    grid = pl.Grid(points=3, size=size)
    indenter = pl.indenter("topography", path=GWY, centre=centre)
    with pytest.raises(pl.ConfigError, match=message):
        indenter.profile(*grid.coordinates())


def test_profile_along_a_line_is_refused(tmp_path: Path) -> None:
    """A line scan is answered with what to do instead."""
    x = np.linspace(0, 1, 20)
    np.savetxt(tmp_path / "line.txt", np.stack([x, np.sin(x)], axis=1))
    with pytest.raises(pl.ConfigError, match=r"^path: .*profile along a line.*type = 'heights'"):
        pl.indenter("topography", path=tmp_path / "line.txt", unit="1 um")


def test_huge_file_is_refused_before_it_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """Memory is estimated from the number of points in the header."""
    monkeypatch.setattr(memory, "available", lambda: 1e4)
    with pytest.raises(pl.ConfigError, match=r"^path: .*39 × 33 .* need about 8\.24e-05"):
        pl.indenter("topography", path=GWY)


def test_without_the_extra_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where SurfaceTopography is not installed, the message has the command."""
    for name in [name for name in sys.modules if name.partition(".")[0] == "SurfaceTopography"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    with pytest.raises(pl.ConfigError, match=r"^type: .*pip install 'pellicle\[topography\]'"):
        pl.indenter("topography", path=GWY)


def test_no_such_file() -> None:
    """A file that is not there is named."""
    with pytest.raises(pl.ConfigError, match=r"^path: nowhere\.x3p: No such file"):
        pl.indenter("topography", path="nowhere.x3p")
