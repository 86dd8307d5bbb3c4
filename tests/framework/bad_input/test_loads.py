"""A load that is not possible: one message that names field, value, and what is allowed."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import pellicle as pl
from tests.framework.bad_input.command_line import Cli, says

LOADINGS = {
    "two": (
        "loading={depth='1 um', force='1 uN'}",
        ["loading: prescribes depth and force", "give exactly one of depth, force, mean_pressure"],
    ),
    "none": ("loading={}", ["loading: prescribes nothing", "give exactly one of"]),
    "empty list": ("loading.depth=[]", ["loading.depth: is empty", "give at least one load step"]),
    "bad entry": ("loading.depth=['1 um', 'x']", ["loading.depth.1: 'x' is not a number"]),
    "half a ramp": (
        "loading.depth={start=0, stop=1}",
        ["loading.depth: a ramp that has start, stop", "give start, stop and num"],
    ),
    "ramp of one": (
        "loading.depth={start=0, stop=1, num=1}",
        ["loading.depth.num: 1 is not allowed", "whole number of values, 2 to"],
    ),
    "ramp without end": (
        "loading.depth={start=0, stop=1, num=1_000_000_000_000}",
        ["loading.depth.num: 1000000000000 is not allowed", "2 to 1000000"],
    ),
    "ramp with a wrong word": (
        "loading.depth={start=0, stop=1, num=3, backwards=true}",
        ["loading.depth: a ramp that has start, stop, num, backwards", "back = true"],
    ),
    "ramp back by number": (
        "loading.depth={start=0, stop=1, num=3, back=1}",
        ["loading.depth.back: 1 is not allowed", "give true or false"],
    ),
    "log ramp from zero": (
        "loading.depth={start=0, stop=1, num=3, spacing='log'}",
        ['loading.depth: spacing = "log" needs start and stop ≠ 0'],
    ),
    "area over the domain": (
        "loading={contact_area=['0.1 mm**2', '1 mm**2']}",
        ["loading.contact_area.1: 1 mm² is more than the domain has, 0.19998", "give less"],
    ),
    "area below what touches first": (
        "loading={contact_radius='1 um'}",
        ["loading.contact_radius.0: 1 µm is less than the 4 cells", "use more points"],
    ),
    "area in another unit": (
        "loading={contact_area='1 mm'}",
        ["loading.contact_area: '1 mm' is a length, not an area", "'0.01 mm**2'"],
    ),
    "mean plane of an endless indenter": (
        "loading={mean_plane_depth='1 um'}",
        ["loading.mean_plane_depth: is not defined", "prescribe depth"],
    ),
    "ramp in another unit": (
        "loading.depth={start='1 um', stop='1 N', num=3}",
        ["loading.depth.stop: '1 N' is a force, not a length"],
    ),
    "mean pressure on a free boundary": (
        "loading={mean_pressure='1 kPa'}",
        ["loading.mean_pressure: ", 'grid.boundary = "free"', "prescribe force or depth", "period"],
    ),
    "no formats": (
        "outputs=[{type='figures', formats=[]}]",
        ["outputs.0.formats: [] is not allowed; give a list of 1 or more"],
    ),
}


@pytest.mark.parametrize(("change", "words"), LOADINGS.values(), ids=LOADINGS)
def test_loading(refuse: Callable[..., str], change: str, words: list[str]) -> None:
    """Load steps that cannot be meant are refused with the forms that can."""
    says(refuse(change), *words)


PUNCH = "indenter={type='flat_punch', radius='0.1 mm'}"


@pytest.mark.parametrize(
    ("loading", "words"),
    [
        ("contact_area='0.1 mm**2'", ["contact_area.0: 0.1 mm² is more than the indenter has"]),
        (
            "contact_radius='0.1 mm'",
            ["contact_radius.0: 100 µm is not", "flat", "prescribe depth"],
        ),
        ("mean_plane_depth='1 um'", ["mean_plane_depth: is not defined", "prescribe depth"]),
    ],
)
def test_loading_of_a_punch(refuse: Callable[..., str], loading: str, words: list[str]) -> None:
    """A flat punch has one area, whatever the load, and no mean plane."""
    says(refuse(PUNCH, f"loading={{{loading}}}"), *words)


def test_depth_before_first_touch(refuse: Callable[..., str]) -> None:
    """The mean plane may be that high, but no higher, for the lowest point to touch."""
    changes = ["grid.boundary='periodic'", "loading={mean_plane_depth=['-10 um', '-1 mm']}"]
    words = "-1 mm is before first touch", "give -16.6006 µm", "or more"
    says(refuse(*changes), "loading.mean_plane_depth.1", *words)


def test_depth_beyond_full_contact(refuse: Callable[..., str]) -> None:
    """On a periodic grid, no load reaches a depth below the indenter's mean plane."""
    message = refuse("grid.boundary='periodic'", "loading.depth=['1 um', '1 mm']")
    says(message, "loading.depth.1: 1 mm is beyond full contact", "mean plane", "give less")


def test_area_of_few_cells(cli: Cli) -> None:
    """An area that no number of whole cells comes near to is marked, one they nearly have said."""
    loading = "loading={contact_area=['4.7e-9 m**2', '4.6e-8 m**2']}"
    outcome = cli("run", "start.toml", "-o", "out", "--set", loading)
    assert outcome.exit_code == 1
    says(outcome.message, "step 1 did not converge: the contact area misses", "use more points")
    says(outcome.message, "step 2: converged; the contact area misses", "nearer number of whole")
    kept = pl.load("out/start.h5").dataset
    assert kept["converged"].values.tolist() == [False, True]


@pytest.mark.parametrize(
    ("loading", "boundary", "named"),
    [
        ("{depth='1 mm'}", "free", "loading.depth = 1 mm"),
        ("{force='1 N'}", "free", "loading.force = 1 N"),
        ("{contact_area='0.19 mm**2'}", "free", "loading.contact_area = 0.19 mm²"),
        ("{mean_pressure='1 MPa'}", "periodic", "loading.mean_pressure = 1 MPa"),
    ],
)
def test_contact_reaches_the_edge(cli: Cli, loading: str, boundary: str, named: str) -> None:
    """A load beyond the domain's reach leaves a result that is marked, and exit code 1."""
    changes = ["--set", f"loading={loading}", "--set", f"grid.boundary='{boundary}'"]
    outcome = cli("run", "start.toml", "-o", "out", *changes)
    assert outcome.exit_code == 1
    says(outcome.message, "step 1 did not converge", "reaches the edge", named)
    says(outcome.message, "enlarge grid.size = 447.2 µm × 447.2 µm or press in less far")
    kept = pl.load("out/start.h5").dataset
    assert not kept["converged"].item()
    assert "reaches the edge" in kept["status"].item()
    assert "NOT CONVERGED" in outcome.stdout
