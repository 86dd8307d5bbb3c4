"""The estimate of memory before a run."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import pellicle as pl
from pellicle import memory


def _grid(points: int, boundary: str = "free") -> pl.Grid:
    return pl.Grid(points=points, size=1.0, boundary=boundary)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_estimate_grows_with_cells_and_steps(boundary: str) -> None:
    """Twice the points take four times the memory, and steps that are kept take more."""
    large = memory.estimate(_grid(4096, boundary), 1)
    assert memory.estimate(_grid(8192, boundary), 1) == pytest.approx(4 * large, rel=1e-2)
    assert memory.estimate(_grid(4096, boundary), 10) > 2 * large


# MB at their peak, of fresh processes after a run of 16 × 16 cells: solver active_set, all standard
# outputs, a paraboloid that touches 12 % (free) and 69 % (periodic) of the domain; x86-64, glibc.
MEASURED = {
    ("free", 256): {1: 17.2, 3: 21.3, 8: 32.3, 10: 41.5},
    ("free", 512): {1: 54.3, 2: 65.0, 3: 71.9, 5: 101.9, 8: 129.6, 10: 183.9},
    ("free", 1024): {1: 206.4, 3: 269.3, 6: 431.2},
    ("periodic", 256): {1: 12.2, 3: 21.7, 8: 38.6, 10: 41.1},
    ("periodic", 512): {1: 36.5, 2: 47.8, 3: 63.3, 5: 97.5, 8: 135.7, 10: 199.9},
    ("periodic", 1024): {1: 158.5, 3: 248.3},
    ("periodic", 2048): {1: 604.0},
}


@pytest.mark.parametrize(("boundary", "points"), MEASURED)
def test_estimate_is_over_what_was_measured_but_not_by_much(boundary: str, points: int) -> None:
    """It is never under; the fit is looser where steps are small enough for libc to keep them."""
    for steps, megabytes in MEASURED[boundary, points].items():
        ratio = memory.estimate(_grid(points, boundary), steps) / (megabytes * 1e6)
        assert 1.0 < ratio < (1.45 if steps > 5 else 1.25)


def test_estimate_holds_at_least_the_result() -> None:
    """The estimate is over what the result alone takes: three fields and a flag of each step."""
    assert memory.estimate(_grid(100, "periodic"), 7) > 7 * 100**2 * (3 * 8 + 1)


def test_free_takes_more_than_periodic() -> None:
    """The zero padding of a free boundary is counted."""
    assert memory.estimate(_grid(64), 1) > memory.estimate(_grid(64, "periodic"), 1)


def test_estimate_does_not_overflow() -> None:
    """A number of points beyond floats needs an infinite amount."""
    assert memory.estimate(_grid(10**400), 1) == math.inf


def test_require(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that does not fit is refused, one that fits or on a machine that is silent is not."""
    needed = memory.estimate(_grid(64), 1)
    monkeypatch.setattr(memory, "available", lambda: needed * 0.99)
    with pytest.raises(pl.ConfigError, match=r"grid\.points: 64 × 64 with 1 step needs about"):
        memory.require(_grid(64), 1)
    monkeypatch.setattr(memory, "available", lambda: needed * 1.01)
    memory.require(_grid(64), 1)
    monkeypatch.setattr(memory, "available", lambda: None)
    memory.require(_grid(64), 1)


def test_available() -> None:
    """What this machine says it has is a sensible amount, if it says anything."""
    there = memory.available()
    assert there is None or 1e6 < there < 1e15


MACHINE = 8e9
V2, V1 = "sys/fs/cgroup", "sys/fs/cgroup/memory"


def _system(root: Path, group: str, folders: dict[str, dict[str, str]]) -> Path:
    """Make the files of a system of 8 GB; ``folders`` has those of its control groups."""
    files = {
        "proc/meminfo": {"": "MemTotal: 9000000 kB\nMemAvailable: 7812500 kB\n"},
        "proc/self/cgroup": {"": group},
        **folders,
    }
    for folder, contents in files.items():
        for name, text in contents.items():
            path = root / folder / name if name else root / folder
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    return root


def _v2(limit: object, used: object, cached: int = 0) -> dict[str, str]:
    stat = f"anon 5\ninactive_file {cached}\nactive_file 7\n"
    return {"memory.max": f"{limit}\n", "memory.current": f"{used}\n", "memory.stat": stat}


def _v1(limit: int, used: int, cached: int = 0) -> dict[str, str]:
    return {
        "memory.limit_in_bytes": f"{limit}\n",
        "memory.usage_in_bytes": f"{used}\n",
        "memory.stat": f"inactive_file 5\ntotal_inactive_file {cached}\n",
    }


GIGABYTE = 10**9
GROUPS: dict[str, tuple[str, dict[str, dict[str, str]], float]] = {
    "no groups": ("", {}, MACHINE),
    "v2": ("0::/job\n", {f"{V2}/job": _v2(4 * GIGABYTE, GIGABYTE)}, 3e9),
    "v2, file cache is given up": (
        "0::/job\n",
        {f"{V2}/job": _v2(4 * GIGABYTE, 3 * GIGABYTE, 2 * GIGABYTE)},
        3e9,
    ),
    "v2, a group around it has less": (
        "0::/user/job\n",
        {f"{V2}/user/job": _v2("max", 1), f"{V2}/user": _v2(2 * GIGABYTE, GIGABYTE)},
        1e9,
    ),
    "v2, seen from inside": ("0::/\n", {V2: _v2(2 * GIGABYTE, GIGABYTE)}, 1e9),
    "v2, named as seen from outside": (
        "0::/docker/0123\n",
        {V2: _v2(2 * GIGABYTE, GIGABYTE)},
        1e9,
    ),
    "v2, no limit": ("0::/job\n", {f"{V2}/job": _v2("max", GIGABYTE)}, MACHINE),
    "v2, more than the machine has": (
        "0::/job\n",
        {f"{V2}/job": _v2(64 * GIGABYTE, GIGABYTE)},
        MACHINE,
    ),
    "v2, nothing left": ("0::/job\n", {f"{V2}/job": _v2(GIGABYTE, GIGABYTE + 5)}, 0.0),
    "v2, without the controller": ("0::/job\n", {f"{V2}/job": {"cgroup.procs": "1\n"}}, MACHINE),
    "v1": (
        "4:cpu,cpuacct:/elsewhere\n3:memory:/job\n1:name=systemd:/\n0::/\n",
        {f"{V1}/job": _v1(4 * GIGABYTE, 3 * GIGABYTE, GIGABYTE)},
        2e9,
    ),
    "v1, no limit": ("3:memory:/\n", {V1: _v1(9223372036854771712, GIGABYTE)}, MACHINE),
}


@pytest.mark.parametrize("which", GROUPS)
def test_available_respects_control_groups(which: str, tmp_path: Path) -> None:
    """Containers and batch systems bound what a process may have of the machine's memory."""
    group, folders, expected = GROUPS[which]
    assert memory.available(_system(tmp_path, group, folders)) == pytest.approx(expected)


def test_unreadable_groups_are_no_limit(tmp_path: Path) -> None:
    """A limit that cannot be read, a folder in its place, is passed over."""
    root = _system(tmp_path, "0::/job\n", {f"{V2}/job": {"memory.current": "5"}})
    (root / V2 / "job" / "memory.max").mkdir()
    assert memory.available(root) == pytest.approx(MACHINE)
