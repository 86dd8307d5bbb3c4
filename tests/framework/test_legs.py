"""Paths in legs: their samples, what describes them, and what is refused."""

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import pellicle as pl
from tests.command import call
from tests.tables_of_runs import half_space, relaxing

LEGS: list[dict[str, Any]] = [
    {"to": "1 um", "time": "1 s", "num": 4},
    {"hold": "5 s", "num": 2},
    {"amplitude": "10 nm", "frequency": "0.5 Hz", "cycles": 2, "num": 4},
]
RUN: dict[str, Any] = {
    "title": "legs",
    "grid": {"points": 12, "size": "1 mm", "boundary": "free"},
    "kernel": relaxing(half_space("10 kPa"), 0.8, "2 s"),
    "indenter": {"type": "flat_punch", "radius": "0.2 mm"},
    "loading": {"depth": LEGS},
    "outputs": [],
}


def test_samples_go_on_from_the_end_of_the_leg_before() -> None:
    """A leg has num steps, an oscillation num each cycle; the first begins from 0 at 0 s."""
    loading = pl.Loading(depth=LEGS)
    about = [1.01e-6, 1e-6, 0.99e-6, 1e-6]
    assert loading.values == (2.5e-7, 5e-7, 7.5e-7, 1e-6, 1e-6, 1e-6, *about, *about)
    assert loading.times == (0.25, 0.5, 0.75, 1, 3.5, 6, 6.5, 7, 7.5, 8, 8.5, 9, 9.5, 10)
    assert loading.durations == (*[0.25] * 4, 2.5, 2.5, *[0.5] * 8)
    cycles = [sample.cycle for sample in loading.samples]
    np.testing.assert_array_equal(cycles, [*[np.nan] * 6, *np.arange(1, 9) / 4])


def test_legs_of_another_quantity() -> None:
    """Values have the unit of the prescription, whose fields stand beside."""
    legs = [{**LEGS[0], "to": "2 nN"}, {**LEGS[2], "amplitude": "1 nN"}]
    assert pl.Loading(force=legs).values[3:5] == (2e-9, 3e-9)
    base = pl.Loading(base_displacement=LEGS, spring_constant="1 N/m")
    assert base.values == pl.Loading(depth=LEGS).values


@pytest.mark.parametrize(
    ("name", "first", "second"),
    [("mean_plane_depth", "-2 um", "-1 um"), ("gap_volume", "2e-12 m^3", "1e-12 m^3")],
)
def test_what_is_not_zero_at_rest_begins_with_a_jump(name: str, first: str, second: str) -> None:
    """On the way from 0 a solid that relaxes would be pressed to full contact first."""
    slow = {"to": second, "time": "1 s", "num": 4}
    jump = {"to": first, "time": 0, "num": 1}
    for legs in ([slow], [{**jump, "num": 2}, slow]):
        with pytest.raises(pl.ConfigError, match=rf"loading\.{name}\.0: begins at 0, which is not"):
            pl.Run(**{**RUN, "loading": {name: legs}})
        pl.Run(**{**RUN, "kernel": RUN["kernel"]["solid"], "loading": {name: legs}})
    pl.Run(**{**RUN, "loading": {name: [jump, slow]}})


def test_time_of_nought_is_a_jump() -> None:
    """All steps of such a leg have one time."""
    loading = pl.Loading(force=[{"to": 2.0, "time": 0, "num": 2}, {"hold": 1, "num": 1}])
    assert loading.values == (1.0, 2.0, 2.0)
    assert loading.times == (0.0, 0.0, 1.0)


def test_a_run_with_legs_is_one_in_every_form() -> None:
    """JSON, TOML, a pickle and a copy of its parts describe the same run, which the schema takes.

    The schema refuses legs that mix keys.
    """
    run = pl.Run(**RUN)
    assert pl.Run.from_json(run.to_json()) == run
    assert pickle.loads(pickle.dumps(run)) == run
    assert pl.Run(**{name: getattr(run, name) for name in run.model_fields_set}) == run
    configuration = json.loads(run.to_json())
    validator = Draft202012Validator(pl.json_schema())
    validator.validate(configuration)
    validator.validate({**configuration, "loading": {"depth": LEGS}})
    configuration["loading"]["depth"][1]["frequency"] = 1.0
    assert not validator.is_valid(configuration)
    assert run.identity != pl.Run(**{**RUN, "loading": {"depth": LEGS[:2]}}).identity


def test_the_first_leg_is_no_jump() -> None:
    """Under a flat punch pressed in at a constant speed F(t)/F₀ = ∫ E(t − t′) dt′, from 0 s on."""
    data = pl.run(RUN, progress=False).dataset
    t, force = data["time"].values[:4], data["force"].values[:4]
    growth = 0.2 * t + 0.8 * 2 * -np.expm1(-t / 2)
    at_once = {**RUN, "loading": {"depth": "1 um", "time": 0}}
    stiffness = pl.run(at_once, progress=False).dataset["force"].item()
    np.testing.assert_allclose(force, stiffness * growth, rtol=1e-8)


def test_legs_at_the_command_line(tmp_path: Path) -> None:
    """Values of legs can be set; the plan counts their steps, the listing shows their times."""
    file, folder = tmp_path / "legs.toml", tmp_path / "out"
    file.write_text(pl.Run(**RUN).to_toml(), encoding="utf-8")
    command = ["run", str(file), "-o", str(folder), "--set", "loading.depth.2.cycles=1"]
    assert " 10 " in call(*command, "--dry-run").output
    call(*command)
    result = pl.load(folder / "legs.h5")
    assert result.planned_steps == result.dataset.sizes["step"] == 10
    shown = call("show", folder / "legs.h5").output
    head = next(line for line in shown.splitlines() if line.startswith("step"))
    assert head.split()[:5] == ["step", "time", "[s]", "depth", "[µm]"]


@pytest.mark.parametrize("run", [RUN, pl.Run(**RUN)], ids=["mapping", "run"])
def test_a_study_varies_legs(run: Any) -> None:
    """Whole paths are axes, and the frequency and the end of a leg are, with their units."""
    whole = pl.Study(run=run, vary={"loading.depth": [LEGS[:1], LEGS[:2]]})
    assert [point.run.steps for point in whole.points] == [4, 6]
    again = pl.Study.from_json(whole.to_json())
    assert [point.run for point in again.points] == [point.run for point in whole.points]
    study = pl.Study(
        run=run,
        vary={
            "loading.depth.2.frequency": ["1 Hz", "10 Hz"],
            "loading.depth.0.to": ["1 um", "2 um"],
        },
    )
    coordinates = study.coordinates()
    _, (frequencies, about) = coordinates["loading.depth.2.frequency"]
    np.testing.assert_array_equal(frequencies, [1.0, 10.0])
    assert about["units"] == "Hz"
    assert coordinates["loading.depth.0.to"][1].attributes["units"] == "m"
    assert study.points[-1].run.loading.samples[-1].time == pytest.approx(6.2)
