"""The sentence that a study's page begins with."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from pellicle.variables import VARIABLES
from pellicle_plugins.outputs.html_sentences import aim_of_path, sentence_of_study

RADII = {"contact_radius": [[1e-6, 6.33e-6], [1e-6, 4.62e-6]], "patches": [[1, 1], [1, 1]]}


def table(**values: list[list[float]]) -> xr.Dataset:
    """Return the table of runs of two tensions and two steps."""
    return xr.Dataset(
        {
            name: (("tension", "step"), np.array(rows), VARIABLES[name].attributes)
            for name, rows in values.items()
        },
        {"tension": ("tension", [0.0, 8e-3], {"units": "N/m"}), "step": [1, 2]},
    )


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        (
            {"depth": [[1e-6, 3e-6]] * 2, "force": [[1e-9, 47.6e-9], [1e-9, 118e-9]], **RADII},
            "at depth 3 µm: force 47.6, 118 nN, contact radius 6.33, 4.62 µm.",
        ),
        (
            {"depth": [[1e-6, 3e-6], [1e-6, 2e-6]], "force": [[1e-9, 5e-9]] * 2},
            "at force 5 nN: depth 3, 2 µm.",
        ),
        (
            {"depth": [[1e-6, 3e-6], [1e-6, np.nan]], "force": [[1e-9, 4e-9], [1e-9, np.nan]]},
            "at depth 3 µm: force 4 nN.",
        ),
        (
            {"depth": [[1e-6, 3e-6], [1e-6, 2e-6]], "force": [[1e-9, 5e-9], [1e-9, 6e-9]]},
            "in the last step: depth 3, 2 µm, force 5, 6 nN.",
        ),
    ],
)
def test_a_study_answers_at_what_its_runs_share(
    values: dict[str, list[list[float]]], sentence: str
) -> None:
    """Numbers are those of the last step, in the order of the runs."""
    assert sentence_of_study(table(**values), 2) == f"2 runs with tension 0, 8 mN/m; {sentence}"


def test_many_runs_are_a_range() -> None:
    """More than five numbers are not listed."""
    values = {"depth": [[1e-6, 3e-6]] * 2, "force": [[1e-9, 47.6e-9], [1e-9, 118e-9]]}
    assert "at depth 3 µm: force from 47.6 to 118 nN" in sentence_of_study(table(**values), 6)


def test_without_numbers_there_is_no_sentence() -> None:
    """Runs that all failed are not described."""
    nothing = [[1e-9, np.nan]] * 2
    assert sentence_of_study(table(depth=nothing, force=nothing), 2) == ""


def test_a_path_is_told_by_what_it_was_made_for() -> None:
    """Pull-off has the unit of all forces; of a hold the force before and after it is told."""
    columns = {"time": [0.1, 1, 5], "depth": [1e-6, 2e-6, 2e-6], "force": [1e-9, 9e-9, 4e-9]}
    data = xr.Dataset(
        {name: ("step", np.array(v), VARIABLES[name].attributes) for name, v in columns.items()},
        attrs={"prescribed": "depth"},
    )
    held = aim_of_path(data, {})
    assert (
        held == "Force 9 nN at its peak, after 1 s; force 4 nN at the end of the hold, after 5 s."
    )
    pulled = aim_of_path(data, {"pull_off": -2e-10, "pull_off_depth": -1e-7})
    assert pulled == "Pull-off force -0.2 nN, depth at pull-off -0.1 µm."
    assert aim_of_path(data.isel(step=[0, 1]), {"pull_off": np.nan}) == ""
