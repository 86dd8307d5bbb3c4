"""Results: their variables and caveats, what they know, and saving and loading them."""

import csv
import math
import re
import tracemalloc
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.components.installed import registry
from pellicle.contact.caveats import (
    Caveat,
    Status,
    by_phrase,
    from_text,
    rank_caveats,
    sentence_of,
    status_of,
    to_text,
)
from pellicle.plugins.origins import Origin
from pellicle.results import storage
from tests.command import call
from tests.tables_of_runs import RUN, paraboloid, pressing, tensed

CONFIGURATION: dict[str, Any] = pressing(
    [16, 12], "0.4472 mm", tensed("10 kPa", "10 mN/m"), paraboloid("1 mm"), depth=["10 um", "20 um"]
) | {
    "title": "τ₀",
    "solver": {"type": "conjugate_gradient", "tolerance": 1e-6},
    "corrections": [{"type": "yastrebov"}],
}


@pytest.fixture(scope="module")
def result() -> pl.Result:
    """Return a small result of two steps."""
    return pl.run(CONFIGURATION, progress=False)


def test_save_and_load(result: pl.Result, tmp_path: Path) -> None:
    """A result that is saved is loaded equal, and its configuration is the run that made it."""
    path = tmp_path / "new" / "result.h5"
    result.save(path)
    loaded = pl.load(str(path))
    xr.testing.assert_identical(loaded.dataset, result.dataset)
    assert pl.Run(**loaded.configuration) == pl.Run(**CONFIGURATION)


def test_provenance_of_components_within_components(monkeypatch: pytest.MonkeyPatch) -> None:
    """The versions name the package of a kernel that another kernel holds."""
    own = registry()
    inner = own.components["kernel"]["half_space"]
    foreign = replace(inner, origin=Origin("kernel.half_space", "other-package", "9.9"))
    kernels = {**own.components["kernel"], "half_space": foreign}
    theirs = replace(own, components={**own.components, "kernel": kernels})
    monkeypatch.setattr("pellicle.config.provenance.registry", lambda: theirs)
    substrate = {"type": "half_space", "reduced_modulus": "10 kPa"}
    coated = CONFIGURATION | {"kernel": {"type": "coated", "substrate": substrate}, "outputs": []}
    versions = pl.run(coated, progress=False).dataset.attrs["versions"]
    assert "other-package 9.9" in versions.split(", ")


def test_provenance_names_what_components_compute_with(monkeypatch: pytest.MonkeyPatch) -> None:
    """The versions are those of numpy, scipy, and the libraries of a component; none if absent."""
    inner = registry().components["indenter"]["paraboloid"].component
    monkeypatch.setattr(inner, "libraries", ("xarray", "pellicle-no-such-library"))
    run = CONFIGURATION | {"outputs": [], "loading": {"depth": 0.0}}
    versions = pl.run(run, progress=False).dataset.attrs["versions"].split(", ")
    used = ("pellicle", "numpy", "scipy", "xarray")
    assert versions == [f"{name} {version(name)}" for name in used]


def test_steps_are_joined_with_one_field_twice_at_a_time() -> None:
    """Joining uses up the list, and takes much less than another copy of all."""
    tracemalloc.start()
    try:
        fields = {name: (("step", "x", "y"), np.ones((1, 64, 64))) for name in "abcdef"}
        steps = [xr.Dataset(fields).copy(deep=True) for _ in range(4)]
        del fields
        whole = sum(step.nbytes for step in steps)
        before, _ = tracemalloc.get_traced_memory()
        tracemalloc.reset_peak()
        joined = storage.join_steps(steps)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert (steps, joined.sizes["step"]) == ([], 4)
    assert peak - before < 0.4 * whole


@pytest.mark.parametrize("lost", ["force", "pressure", "converged"])
def test_load_of_a_result_that_lost_a_part(result: pl.Result, tmp_path: Path, lost: str) -> None:
    """A file without what every result has is damaged, and that is said before it is used."""
    pl.Result(result.dataset.drop_vars(lost)).save(tmp_path / "part.h5")
    with pytest.raises(pl.StorageError, match=rf"part\.h5: lacks {lost}, so it is damaged"):
        pl.load(tmp_path / "part.h5")


SOLID = {"reduced_modulus": "10 kPa", "poissons_ratio": 0.45}
LAYER = {**SOLID, "thickness": "2 um"}


@pytest.mark.parametrize(
    ("kernel", "depth", "message"),
    [
        ({"type": "bonded_layer", **LAYER}, 3e-6, "through a layer 2 µm thick to its rigid base"),
        (
            {"type": "coated", "tension": 0.01, "substrate": {"type": "bonded_layer", **LAYER}},
            3e-6,
            "pressed down by 2.9",
        ),
        ({"type": "layered", "layers": [LAYER], "substrate": "rigid"}, 3e-6, "through a layer"),
        ({"type": "half_space", "reduced_modulus": "10 kPa"}, 90e-6, "slopes in contact reach 1."),
        ({"type": "bonded_layer", **LAYER}, 1.9e-6, ""),
        ({"type": "layered", "layers": [LAYER], "substrate": SOLID}, 3e-6, ""),
    ],
)
def test_beyond_the_theory(kernel: dict[str, Any], depth: float, message: str) -> None:
    """A solved contact through a layer, or as deep as the indenter is round, is warned of."""
    run = pressing(
        32, 4 * (50e-6 * depth) ** 0.5, kernel, paraboloid("50 um"), depth=[depth / 4, depth]
    )
    if message:
        with pytest.warns(pl.ConvergenceWarning, match=f"step 2: .*{message}"):
            result = pl.run(run, progress=False)
    else:
        result = pl.run(run, progress=False)
        assert not result.warnings()
    told = "THROUGH_LAYER" if kernel["type"] != "half_space" else "STEEP"
    codes = ["CONVERGED", told if message else "CONVERGED"]
    assert result.dataset["status_code"].values.tolist() == codes
    assert result.converged


def test_study_beyond_the_theory(tmp_path: Path) -> None:
    """A study warns once, with a run, its step and figures; its table keeps those of all runs."""
    study = pressing(
        40, "90 um", {"type": "bonded_layer", **LAYER}, paraboloid("50 um"), depth=["1 um", "4 um"]
    ) | {"outputs": [], "study": {"vary": {"loading.depth.1": ["1.2 um", "4 um", "5 um"]}}}
    for _ in ("solved", "resumed"):
        with pytest.warns(UserWarning, match="pressed through a layer") as caught:
            table = pl.run_study(study, tmp_path, progress=False)
        (message,) = (str(warned.message) for warned in caught)
        assert message.startswith(
            "of 3 runs, in 2 the surface is pressed through a layer to its rigid base; "
        )
        assert re.search(
            r"depth 2 4 µm \(file \w+…\), step 2: .* through a layer .* thick", message
        )
        none, first, second = table["status_code"].values.tolist()
        assert none == ["CONVERGED", "CONVERGED"]
        assert first == second == ["CONVERGED", "THROUGH_LAYER"]
        with (tmp_path / "study.csv").open(encoding="utf-8", newline="") as file:
            texts = [row["status"] for row in csv.DictReader(file)]
        assert texts[:3] == ["converged"] * 3
        assert message.endswith(f"step 2: {texts[3]}")
    shown = call("show", tmp_path)
    assert message in shown.stderr


@pytest.fixture(scope="module")
def dataset() -> xr.Dataset:
    """Return the dataset of three steps on a rectangle."""
    run = pl.Run(**RUN | {"grid": {"points": [20, 16], "size": ["0.4 mm", "0.3 mm"]}})
    return pl.run(run, progress=False).dataset


def test_every_variable_is_described(dataset: xr.Dataset) -> None:
    """Each variable and coordinate says what it is."""
    assert all(variable.attrs["long_name"] for variable in dataset.variables.values())


def test_coordinates_are_cell_centres(dataset: xr.Dataset) -> None:
    """Coordinates are the centres of the cells in metres."""
    x, y = pl.Grid(points=[20, 16], size=["0.4 mm", "0.3 mm"]).coordinates()
    assert np.array_equal(dataset["x"], x.ravel())
    assert np.array_equal(dataset["y"], y.ravel())
    assert dataset["x"].attrs["units"] == dataset["y"].attrs["units"] == "m"


def test_types(dataset: xr.Dataset) -> None:
    """Contact and converged are flags, counts are whole, status is text."""
    assert dataset["contact"].dtype == bool
    assert dataset["converged"].dtype == bool
    assert dataset["iterations"].dtype.kind == "i"
    assert dataset["operator_applications"].dtype.kind == "i"
    assert list(dataset["status"].values) == ["converged"] * 3


def test_numbers_agree_with_fields(dataset: xr.Dataset) -> None:
    """Force, area, fraction and mean pressure are those of the fields."""
    cell, domain = 4e-4 / 20 * 3e-4 / 16, 4e-4 * 3e-4
    contact = dataset["contact"].sum(("x", "y")).values
    force = dataset["pressure"].sum(("x", "y")).values * cell
    assert dataset["force"].values == pytest.approx(force, rel=1e-12)
    assert dataset["mean_pressure"].values == pytest.approx(force / domain, rel=1e-12)
    assert dataset["contact_area"].values == pytest.approx(contact * cell, rel=1e-12)
    assert dataset["contact_fraction"].values == pytest.approx(contact * cell / domain, rel=1e-12)
    assert np.array_equal(dataset["contact"], dataset["pressure"] > 0)
    assert dataset["depth"].values == pytest.approx([5e-6, 10e-6, 15e-6])


VALUES: dict[str, float | str] = {
    "quantity": "contact area",
    "unit": "m**2",
    "below": 1e-12,
    "above": 2e-12,
    "end": "jump",
    "remedy": "larger domain",
    "loss": "known",
    "off": "known error",
    "error": 0.1,
    "stop": "ITERATION_LIMIT",
    "prescribed": "depth",
    "reason": "no memory",
}
NUMBERS = re.compile(r"{(\w+):(?:[mNJ]|count|g|\.\d[ef%])}")


def _filled(status: Status) -> Caveat:
    numbers = dict.fromkeys(NUMBERS.findall(status.value), 3)
    return Caveat(status, {**VALUES, "value": 1e-6, "least_size": 1e-3, "lost": 1e-9, **numbers})


@pytest.mark.parametrize("status", Status)
def test_a_caveat_in_a_file_says_the_same(status: Status) -> None:
    """Every template can be filled from what a file holds."""
    caveat = _filled(status)
    assert "{" not in caveat.sentence
    (read,) = from_text(to_text([caveat]))
    assert read == caveat
    assert read.sentence == caveat.sentence


def test_numbers_that_are_not_finite_are_read_again() -> None:
    """An infinite length is one in a file too, and JSON stays JSON."""
    text = to_text([Caveat(Status.JUMPED, {"lost": math.nan, "until": math.inf})])
    ((_, values),) = from_text(text)
    assert "Infinity" not in text
    assert values["until"] == math.inf
    assert math.isnan(float(values["lost"]))


def test_a_failure_hides_the_rest_and_the_gravest_comes_first() -> None:
    """The numbers of a failed step mean nothing; coarse cells are coarse in the zone, too."""
    jumped, zone, coarse = map(_filled, (Status.JUMPED, Status.COARSE_ZONE, Status.COARSE))
    load, nan = _filled(Status.LOAD), _filled(Status.NOT_FINITE)
    assert rank_caveats([jumped, load, nan, coarse]) == (nan,)
    assert rank_caveats([jumped, zone, coarse]) == (coarse, jumped)
    assert rank_caveats([jumped, zone]) == (zone, jumped)
    assert rank_caveats([]) == ()
    assert status_of(rank_caveats([jumped, load])) is Status.LOAD
    assert status_of(()) is Status.CONVERGED


def test_a_message_of_two_caveats_says_once_that_the_step_converged() -> None:
    """The sentences follow each other, the gravest first."""
    coarse, jumped = _filled(Status.COARSE), _filled(Status.JUMPED)
    message = sentence_of([coarse, jumped])
    assert message.startswith(coarse.sentence)
    assert message.count("converged") == 1
    assert message.endswith(jumped.sentence.partition("; ")[2])


def test_caveats_are_grouped_by_phrase() -> None:
    """The gravest first, within a phrase in the order of the steps."""
    several = [_filled(s) for s in (Status.JUMPED, Status.COARSE, Status.JUMPED)]
    groups = by_phrase(enumerate([*several, _filled(Status.COARSE_ZONE)]))
    assert [[place for place, _ in group] for group in groups.values()] == [[1, 3], [0, 2]]
