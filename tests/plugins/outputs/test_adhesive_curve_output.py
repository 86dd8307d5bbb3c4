"""What the output of the adhesive curve leaves behind."""

import re
from math import isnan, pi
from pathlib import Path
from typing import Any

import pytest

import pellicle as pl
from pellicle.errors import ConfigError
from pellicle.results import StoredRuns
from pellicle_plugins.outputs.adhesive_curve import AdhesiveCurve
from tests.plugins.outputs.shared import bead, rows

WORK = 0.5e-3
OUTPUT = {"type": "adhesive_curve", "work_of_adhesion": "0.5 mJ/m^2"}
DEPTHS = {"start": "2 um", "stop": "28 um", "num": 9, "spacing": "log"}
BEAD = bead(
    title="bead",
    grid={"points": 48, "size": "180 um"},
    kernel={"type": "tensed_membrane", "reduced_modulus": "1 kPa", "tension": 0.0},
    indenter={"type": "paraboloid", "radius": "0.2 mm"},
    loading={"depth": DEPTHS, "stiffness": True},
    outputs=[OUTPUT],
)
FORCE = pi * WORK * 0.2e-3
"""πwR [N]."""


def ran(folder: Path, **changed: Any) -> tuple[list[dict[str, str]], list[dict[str, str]]]:
    """Run the bead with changed parts; return the rows of the curve and of its summary."""
    configuration = BEAD | {key: {**BEAD[key], **value} for key, value in changed.items()}
    pl.run(configuration, directory=folder, progress=False, threads=1)
    names = "bead-adhesive_curve.csv", "bead-adhesive_curve-summary.csv"
    return rows(folder / names[0]), rows(folder / names[1])


def test_summary_and_curve_are_those_of_the_bead(tmp_path: Path) -> None:
    """On a grid of 48 cells pull-off is right to 0.03 πwR, and the lowest force of the curve."""
    curve, (summary,) = ran(tmp_path)
    assert summary["status"].startswith("contact radius in cells: pull-off 11.0, last at fixed")
    # The slope of a paraboloid at the rim is a/R.
    assert "slope of the indenter at the rim: no load 0.3" in summary["status"]
    pull_off = float(summary["pull_off_force [N]"])
    assert pull_off == pytest.approx(-1.5 * FORCE, abs=0.03 * FORCE)
    assert min(float(row["force [N]"]) for row in curve) == pytest.approx(pull_off, rel=1e-4)
    radius = (9 * pi * WORK * 0.2e-3**2 / 2 / 1e3) ** (1 / 3)
    assert float(summary["zero_load_radius [m]"]) == pytest.approx(radius, rel=0.01)
    assert (tmp_path / "bead-adhesive_curve.png").exists()


@pytest.mark.slow
def test_a_study_has_a_curve_for_each_value(tmp_path: Path) -> None:
    """Tension weakens pull-off, from 1.5 πwR towards πwR."""
    output = OUTPUT | {"by": "kernel.tension", "label": "{1e3 * kernel.tension}"}
    study = {"vary": {"kernel.tension": ["0 N/m", "20 mN/m"]}}
    configuration = BEAD | {"outputs": [output], "study": study}
    pl.run_study(configuration, directory=tmp_path, progress=False)
    summary = rows(tmp_path / "study-adhesive_curve-summary.csv")
    pulls = [-float(row["pull_off_force [N]"]) / FORCE for row in summary]
    assert [row["curve"] for row in summary] == ["0", "20"]
    assert 1.5 > pulls[0] - 0.03 > pulls[1] > 1
    assert {row["curve"] for row in rows(tmp_path / "study-adhesive_curve.csv")} == {"0", "20"}


def test_what_the_path_does_not_contain_is_unknown(tmp_path: Path) -> None:
    """A deep path has no pull-off, and its status says which radii it has."""
    deep = {"start": "20 um", "stop": "28 um", "num": 8}
    _, (summary,) = ran(tmp_path, loading={"depth": deep})
    assert isnan(float(summary["pull_off_force [N]"]))
    assert "pull-off" in summary["status"]
    assert "those of the path" in summary["status"]


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"loading": {"depth": ["5 um", "10 um"], "stiffness": True}}, "2 steps.*at least 8"),
        (
            {"indenter": {"type": "sphere", "radius": "0.2 mm", "flat_radius": "20 um"}},
            "flat end of radius 1.98e-05 m holds .* begin at a smaller depth",
        ),
        (
            {"indenter": {"type": "quadric", "radius_x": "0.2 mm", "radius_y": "0.25 mm"}},
            "not a circle",
        ),
    ],
)
def test_why_there_is_no_curve_is_told_in_the_files(
    changed: dict[str, Any], message: str, tmp_path: Path
) -> None:
    """Interrupted runs have their files too, and the theory is for circles."""
    pl.run(BEAD | changed, directory=tmp_path, progress=False, threads=1)
    assert rows(tmp_path / "bead-adhesive_curve.csv") == []
    (summary,) = rows(tmp_path / "bead-adhesive_curve-summary.csv")
    assert re.search(message, summary["status"])


def test_a_path_with_adhesion_is_refused() -> None:
    """Adhesion would count twice."""
    result = pl.run(BEAD | {"loading": {"depth": "5 um"}, "outputs": []}, progress=False).dataset
    output = AdhesiveCurve(work_of_adhesion=WORK)
    with pytest.raises(ConfigError, match="interaction"):
        output.write(StoredRuns.of_run(result.assign_attrs(adheres=1)), Path("unwritten"))
