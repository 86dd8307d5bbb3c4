"""From a study file to its runs: axes, identity, JSON schema, and what is wrong with them."""

import json
import tomllib
from copy import deepcopy
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from jsonschema import Draft202012Validator

import pellicle as pl
from pellicle.config.study import Study
from pellicle.results.derived import names
from pellicle.schema import replace_at
from pellicle.studies.table import StudyTable
from tests.tables_of_runs import paraboloid, pressing, tensed

RUN: dict[str, Any] = pressing(
    16, "0.4 mm", tensed("10 kPa", "1 N/m"), paraboloid("1 mm"), depth=["5 um", "10 um"]
) | {"solver": {"type": "active_set"}, "corrections": [{"type": "yastrebov"}]}
TENSION = "kernel.tension"


def study(vary: object = None, **others: Any) -> Study:
    """Return a study of the run above."""
    return Study(run=RUN, vary={} if vary is None else vary, **others)


def test_product() -> None:
    """Each value is combined with each; the last axis varies fastest."""
    plan = study({TENSION: [0, "10 mN/m"], "indenter.radius": ["1 mm", "2 mm", "3 mm"]})
    assert plan.shape == (2, 3)
    assert [point.position for point in plan.points][:4] == [(0, 0), (0, 1), (0, 2), (1, 0)]
    for point in plan.points:
        assert point.run.kernel.model_dump()["tension"] == [0.0, 0.01][point.position[0]]
        radius = point.run.indentation.indenter.model_dump()["radius"]
        assert radius == pytest.approx([1e-3, 2e-3, 3e-3][point.position[1]])
        assert point.run.loading == plan.points[0].run.loading


def test_zip() -> None:
    """Zipped axes take their values together and share one dimension, next to the product's."""
    zipped = [{"indenter.radius": ["1 mm", "2 mm"], "grid.size": ["0.4 mm", "0.8 mm"]}]
    plan = study({TENSION: [0, 1]}, zip=zipped)
    assert plan.dimensions.keys() == {TENSION, "indenter.radius"}
    assert plan.shape == (2, 2)
    pairs = {
        (p.run.indentation.indenter.model_dump()["radius"], p.run.grid.size[0]) for p in plan.points
    }
    assert pairs == {(1e-3, 0.4e-3), (2e-3, 0.8e-3)}
    assert plan.coordinates()["grid.size"][0] == "indenter.radius"


@pytest.mark.parametrize(
    ("key", "given", "expected"),
    [
        (TENSION, {"start": "0 mN/m", "stop": "100 mN/m", "num": 3}, [0, 0.05, 0.1]),
        (
            TENSION,
            {"start": "10 mN/m", "stop": "1 N/m", "num": 3, "spacing": "log"},
            [0.01, 0.1, 1],
        ),
        (TENSION, ["10 mN/m", 0.5], [0.01, 0.5]),
        (TENSION, np.array([0.25, 0.5]), [0.25, 0.5]),
        ("grid.points", {"start": 16, "stop": 64, "num": 3, "spacing": "log"}, [16, 32, 64]),
        ("grid.points", [16, [32, 16]], ["16", "[32, 16]"]),
        ("loading.depth", ["5 um", "10 um"], [5e-6, 1e-5]),
        ("loading.depth", [["5 um"], ["5 um", "10 um"]], ['["5 um"]', '["5 um", "10 um"]']),
        ("loading.depth.0", ["1 um", "2 um"], [1e-6, 2e-6]),
        ("corrections", [[], [{"type": "yastrebov"}]], ["[]", '[{"type": "yastrebov"}]']),
        ("corrections.0.type", ["yastrebov"], ["yastrebov"]),
        ("solver.tolerance", {"start": 1e-8, "stop": 1e-6, "num": 2}, [1e-8, 1e-6]),
        (
            "indenter",
            [{"type": "sphere", "radius": "1 mm"}, {"type": "flat_punch", "radius": "50 um"}],
            ["sphere", "flat_punch"],
        ),
    ],
)
def test_values(key: str, given: Any, expected: list[Any]) -> None:
    """Lists and ranges of any parameter become SI numbers, or texts that tell them apart."""
    dimension, coordinate = study({key: given}).coordinates()[key]
    assert dimension == key
    texts = isinstance(expected[0], str)
    assert coordinate.values.tolist() == (expected if texts else pytest.approx(expected, rel=1e-15))
    # Whole numbers, such as seeds, stay whole.
    assert coordinate.values.dtype.kind == ("O" if texts else np.array(expected).dtype.kind)


def test_units() -> None:
    """Coordinates have the unit of their field as results have it, in tuples and load steps too."""
    run = RUN | {"loading": {"contact_area": 1e-9}}
    areas = ["1e-3 mm**2", 2e-9]
    plan = Study(
        run=run, vary={TENSION: [1, 2], "grid.size": [1e-3, 2e-3], "loading.contact_area": areas}
    )
    units = {key: axis.attributes.get("units") for key, (_, axis) in plan.coordinates().items()}
    assert units == {TENSION: "N/m", "grid.size": "m", "loading.contact_area": "m2"}


@pytest.mark.parametrize(
    ("vary", "number"),
    [
        ({"loading.depth.stop": ["8 um", "12 um"]}, "loading.depth.1"),
        ({"loading.depth": [["8 um"], ["12 um", "20 um"]]}, "loading.depth.0"),
        ({"kernel": [RUN["kernel"], RUN["kernel"] | {"tension": 2.0}]}, "kernel.tension"),
        ({"grid.size": ["0.4 mm", "0.5 mm"]}, "grid.size.0"),
    ],
)
def test_derived_takes_no_number_of_the_first_run_for_all(
    vary: dict[str, Any], number: str
) -> None:
    """A number in which the runs differ is refused unless it is an axis, in figures too."""
    run = RUN | {"loading": {"depth": {"start": "5 um", "stop": "10 um", "num": 2}}}
    with pytest.raises(pl.ConfigError, match=rf"derived\.a: '{number}' in .*; name an axis"):
        Study(run=run, vary=vary, derived={"a": f"force / {number}"})
    known = names(StudyTable(Study(run=run, vary=vary)).dataset())
    assert number not in known
    assert known["kernel.reduced_modulus" if "kernel" not in vary else "grid.size.0"] > 0


def test_axes_without_quotes(tmp_path: Path) -> None:
    """A dotted key without quotes makes nested tables in TOML, and means the same."""
    vary = "[study.vary]\nkernel.tension = [0, 1]\nkernel.reduced_modulus = [1e4, 2e4]"
    (tmp_path / "a.toml").write_text(pl.Run(**RUN).to_toml() + vary, encoding="utf-8")
    plan = Study.from_toml(tmp_path / "a.toml", ["study.vary.kernel.tension=[0, 1, 2]"])
    assert plan.dimensions.keys() == {TENSION, "kernel.reduced_modulus"}
    assert plan.shape == (3, 2)


def test_what_varies_may_be_left_out_of_the_run() -> None:
    """A required field needs no value besides those of its axis."""
    kernel = {"type": "tensed_membrane", "reduced_modulus": 1e4}
    assert Study(run=RUN | {"kernel": kernel}, vary={TENSION: [0, 1]}).shape == (2,)
    with pytest.raises(pl.ConfigError, match=r"^run\.kernel\.tension: is missing"):
        Study(run=RUN | {"kernel": kernel}, vary={"indenter.radius": [1e-3]})


def test_a_run_may_be_varied() -> None:
    """A `Run` does as well as the mapping that makes it."""
    vary = {TENSION: [0, 1], "grid.points": [16, 24]}
    runs = [point.run for point in Study(run=pl.Run(**RUN), vary=vary).points]
    assert runs == [point.run for point in study(vary).points]


def test_round_trips() -> None:
    """TOML and JSON of a study make the same runs in the same order."""
    zipped = [{"indenter.radius": ["1 mm", "2 mm"], "grid.size": [4e-4, 8e-4]}]
    plan = Study(
        run=RUN | {"loading": {"contact_radius": 1e-5, "stiffness": True}},
        vary={
            TENSION: {"start": "0 mN/m", "stop": "1 N/m", "num": 3},
            "corrections": [[], [{"type": "yastrebov"}]],
        },
        zip=zipped,
        derived={"s": "stiffness / contact_radius"},
    )
    again = Study.from_json(plan.to_json())
    toml = Study.from_mapping(tomllib.loads(plan.to_toml()))
    for other in (again, toml):
        assert other.points == plan.points
        assert other.dimensions == plan.dimensions
        assert other.derived == plan.derived
        assert other.executor == plan.executor
    jsonschema.validate(json.loads(plan.to_json()), pl.json_schema())


def test_a_run_is_no_study(tmp_path: Path) -> None:
    """It says what makes it one."""
    (tmp_path / "run.toml").write_text(pl.Run(**RUN).to_toml(), encoding="utf-8")
    with pytest.raises(pl.ConfigError, match="study: is missing, so this is a single run"):
        pl.run_study(tmp_path / "run.toml")


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("grid.points", [16, 24]),
        ("grid.size", 4.0000000001e-4),
        ("grid.boundary", "periodic"),
        (TENSION, 1.0000000001),
        ("indenter.radius", 2e-3),
        ("loading.depth", [1e-5, 5e-6]),
        ("loading.depth", [5e-6, 1e-5, 1.1e-5]),
        ("loading.stiffness", True),
        ("solver.tolerance", 1e-7),
        ("corrections", []),
    ],
)
def test_identity_changes_with_any_value(key: str, value: Any) -> None:
    """Whatever decides a number is in the identity."""
    assert pl.Run(**replace_at(RUN, key, value)).identity != pl.Run(**RUN).identity


def test_identity_of_equal_runs() -> None:
    """Units, defaults, order, title and outputs make no other run."""
    run, other = pl.Run(**RUN), {name: RUN[name] for name in reversed(RUN)}
    other |= {
        "title": "other",
        "outputs": [],
        "loading": {"depth": [5e-6, 1e-5]},
        "kernel": {"tension": 1.0, "reduced_modulus": "0.01 MPa", "type": "tensed_membrane"},
        "grid": {"size": [4e-4, "400 um"], "points": [16, 16], "boundary": "free"},
    }
    del other["solver"]
    assert pl.Run(**other).identity == run.identity == pl.Run.from_json(run.to_json()).identity


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"vary": {"kernel" + ".substrate" * 20_000: [1, 2]}}, "leads through 20000 tables; give"),
        ({"vary": {f"kernel.k{n}": [1] for n in range(100_000)}}, "vary: has 100000 entries; giv"),
        ({"vary": {f"kernel.k{n}": list(range(99)) for n in range(900)}}, "more than 10¹⁸ runs"),
        (
            {"vary": {TENSION: [1, 2]}, "derived": {f"d{n}": "force" for n in range(100_000)}},
            "derived: has 100000 entries; give 1000 at most",
        ),
        ({"run": RUN | {"title": "t" * 2000}, "vary": {TENSION: [1, 2]}}, "title: 'ttt"),
    ],
)
def test_studies_without_end_are_refused(changed: dict[str, Any], words: str) -> None:
    """What would take hours is refused in a short message."""
    with pytest.raises(pl.ConfigError, match=words) as refused:
        Study(**{"run": RUN, **changed})
    assert len(str(refused.value)) < 300


STUDIES = Path(__file__).parents[2] / "docs/studies"
COATED: dict[str, Any] = {
    "type": "coated",
    "tension": 1.0,
    "substrate": {"type": "bonded_layer", "reduced_modulus": 1e4, "thickness": 1e-3},
}


@pytest.fixture(scope="module")
def schema() -> Draft202012Validator:
    """Return what checks a file by the schema."""
    Draft202012Validator.check_schema(pl.json_schema())
    return Draft202012Validator(pl.json_schema())


def without(path: str) -> dict[str, Any]:
    """Return the run without one of its entries, such as one of a kernel in its kernel."""
    *tables, last = path.split(".")
    if "substrate" in tables:
        return RUN | {"kernel": COATED}
    table = deepcopy(RUN)
    del (table[tables[0]] if tables else table)[last]
    return table


@pytest.mark.parametrize(
    ("path", "values"),
    [
        ("kernel.tension", ["1 N/m", "2 N/m"]),
        ("indenter.radius", {"start": "1 mm", "stop": "2 mm", "num": 3}),
        ("grid.points", [16, 32]),
        ("kernel.reduced_modulus", ["1 kPa", "10 kPa"]),
        ("kernel", [RUN["kernel"]]),
        ("loading", [{"depth": "1 um"}, {"force": "1 uN"}]),
        ("kernel.substrate.poissons_ratio", [0.3, 0.4]),
    ],
)
def test_what_varies_may_be_left_out(
    path: str, values: object, schema: Draft202012Validator
) -> None:
    """A required entry is missing where an axis gives it, as in a study that can be made."""
    data = without(path) | {"study": {"vary": {path: values}}}
    assert pl.Study.from_mapping(data).points
    schema.validate(data)
    assert not schema.is_valid(without(path))


@pytest.mark.parametrize(
    "change",
    [
        {"kernel": COATED | {"substrate": {"type": "half_space", "reduced_modulus": -1}}},
        {"study": {"executor": {"type": "dusk"}}},
        {"study": {"colour": "red"}},
        {"study": {"derived": {"s": 1}}},
    ],
)
def test_still_rejects(change: dict[str, Any], schema: Draft202012Validator) -> None:
    """Unknown types, keys and values are refused in a study as in a run."""
    study = {"vary": {"kernel.tension": ["1 N/m", "2 N/m"]}} | change.get("study", {})
    schema.validate(RUN | {"study": {"vary": {"kernel.tension": [1.0]}}})
    assert not schema.is_valid(RUN | change | {"study": study})
