"""Runs: from TOML, JSON and keywords, and back."""

import json
import pickle
import tomllib
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import pellicle as pl
from pellicle.components import AreaCorrection, Output
from pellicle.components.installed import registry
from pellicle.components.prescription import OPTIONS
from pellicle.config.loading import Options
from pellicle.schema import get
from tests.tables_of_runs import half_space, paraboloid, pressing

BASE: dict[str, Any] = pressing(16, "1 mm", half_space("10 kPa"), paraboloid("1 mm"), depth="10 um")
VARIANTS: list[dict[str, Any]] = [
    {"title": 'quotes " and \\ and\nlines, \x7f, τ₀ and 🎈'},
    {
        "grid": {"points": [16, 24], "size": ["1 mm", 0.0015], "boundary": "periodic"},
        "loading": {"mean_pressure": ["1 Pa", "0.1 kPa"]},
    },
    {"kernel": {"type": "half_space", "youngs_modulus": "9 kPa", "poissons_ratio": 0.3}},
    {"loading": {"depth": {"start": 0, "stop": "0.1 mm", "num": 7}}, "outputs": []},
    {
        "solver": {"type": "conjugate_gradient", "tolerance": 1e-6, "max_iterations": 7},
        "corrections": [{"type": "yastrebov"}],
        "outputs": [{"type": "csv"}, {"type": "figures", "formats": ["svg"]}],
    },
]
"""Fields of runs that go through every form of a run; the kit asks this of each component."""


@cache
def validator() -> Draft202012Validator:
    """Return the validator of the JSON schema of a run file."""
    return Draft202012Validator(pl.json_schema())


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Return the file of a run with a correction."""
    path = tmp_path / "run.toml"
    path.write_text(pl.Run(**BASE, corrections=[{"type": "yastrebov"}]).to_toml(), "utf-8-sig")
    return path


def test_copy_with_other_values_has_these() -> None:
    """A copy forgets what had been computed of the values that it does not have."""
    loading = pl.Loading(depth=[1e-6, 2e-6])
    assert loading.values == (1e-6, 2e-6)
    assert loading.model_copy(update={"path": (3e-6,)}).values == (3e-6,)
    assert loading.model_copy() == loading


def test_no_prescription_can_take_the_key_of_an_option() -> None:
    """The reserved names are the options that a loading has."""
    assert Options.model_fields.keys() == OPTIONS


def test_loading_of_its_fields() -> None:
    """A loading has a prescription and a path; with these it can be made again."""
    loading = pl.Loading(base_displacement="1 um", spring_constant="2 N/m", stiffness=True)
    assert dict(loading.prescription) == {"type": "base_displacement", "spring_constant": 2.0}
    assert pl.Loading(**dict(loading)) == pl.Loading(**loading.model_dump()) == loading
    assert get(loading, "spring_constant") == 2.0


def test_depths_of_numpy() -> None:
    """Arrays, numbers of numpy and −0 are taken; an array of one number is told that it is none."""
    assert pl.Loading(depth=np.array([1e-6, -0.0])).values == (1e-6, 0.0)
    assert str(pl.Loading(depth="-0 m").values[0]) == "0.0"
    ramp = {"start": np.float64(0), "stop": np.float64(2), "num": np.int64(3)}
    assert pl.Loading(depth=ramp).values == (0, 1, 2)
    with pytest.raises(pl.ConfigError, match="is not a number; give a value with its unit"):
        pl.Loading(depth=np.array(1e-6))


@pytest.mark.parametrize("variant", VARIANTS)
def test_round_trips(variant: dict[str, Any], tmp_path: Path) -> None:
    """TOML, JSON and a pickle are read back equal, and the schema accepts them."""
    run = pl.Run(**(BASE | variant))
    path = tmp_path / "run.toml"
    path.write_text(run.to_toml(), encoding="utf-8")
    assert pl.Run.from_toml(path) == run
    assert pl.Run.from_json(run.to_json()) == run
    assert pickle.loads(pickle.dumps(run)) == run
    validator().validate(json.loads(run.to_json()))


def test_outputs_absent_or_empty() -> None:
    """No word of outputs means the standard ones, an empty list means none."""
    assert pl.Run(**BASE).outputs is None
    assert pl.Run(**BASE, outputs=[]).outputs == ()
    assert pl.Run.from_json(pl.Run(**BASE, outputs=[]).to_json()).outputs == ()


def test_components_or_tables() -> None:
    """A run of component objects equals the run of tables that describe them."""
    from_tables = pl.Run(
        **BASE, solver={"type": "conjugate_gradient"}, corrections=[{"type": "yastrebov"}]
    )
    from_objects = pl.Run(
        grid=pl.Grid(points=16, size="1 mm"),
        kernel=pl.kernel("half_space", reduced_modulus="10 kPa"),
        indenter=pl.indenter("paraboloid", radius="1 mm"),
        loading=pl.Loading(depth=["10 um"]),
        solver=pl.solver("conjugate_gradient"),
        corrections=[registry().make(AreaCorrection, {"type": "yastrebov"})],
    )
    assert from_tables == from_objects
    assert from_tables != pl.Run(**(BASE | {"loading": {"depth": "11 um"}}))


def test_component_of_another_family() -> None:
    """A component in the place of another family is refused."""
    with pytest.raises(pl.ConfigError, match=r"kernel: .*is not a table"):
        pl.Run(**(BASE | {"kernel": pl.indenter("sphere", radius=1)}))
    with pytest.raises(pl.ConfigError, match=r"outputs\.0"):
        pl.Run(**BASE, outputs=[pl.solver("conjugate_gradient")])
    assert isinstance(registry().make(Output, {"type": "csv"}), Output)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("1 um", [1e-6]),
        ([1, "2 m"], [1.0, 2.0]),
        (np.array([1.0, 2.0]), [1.0, 2.0]),
        ({"start": 0, "stop": "1 m", "num": 5}, [0.0, 0.25, 0.5, 0.75, 1.0]),
        ({"start": 1, "stop": 0, "num": 2}, [1.0, 0.0]),
        ({"start": 1, "stop": "100 m", "num": 3, "spacing": "log"}, [1.0, 10.0, 100.0]),
        ({"start": 0, "stop": 2, "num": 3, "back": True}, [0.0, 1.0, 2.0, 1.0, 0.0]),
        ({"start": 0, "stop": 2, "num": 3, "back": False}, [0.0, 1.0, 2.0]),
    ],
)
def test_load_steps(given: object, expected: list[float]) -> None:
    """Load steps are a value, a list, an array or a ramp with both ends."""
    loading = pl.Loading(depth=given)
    assert loading.values == pytest.approx(expected, rel=1e-14)
    assert loading.prescribed == "depth"


def test_ramp_ends_exactly() -> None:
    """The last step of a ramp is its stop, to the last bit."""
    for num in range(2, 50):
        values = pl.Loading(force={"start": 0.1, "stop": 0.7, "num": num}).values
        assert (values[0], values[-1], len(values)) == (0.1, 0.7, num)


@pytest.mark.parametrize(
    ("changes", "path", "value"),
    [
        (["grid.points=8"], "grid.points", [8, 8]),
        (["grid.points = [8, 9]"], "grid.points", [8, 9]),
        (["kernel.reduced_modulus=5 kPa"], "kernel.reduced_modulus", 5e3),
        (['kernel.reduced_modulus="5 kPa"'], "kernel.reduced_modulus", 5e3),
        (["title=a = b"], "title", "a = b"),
        (["corrections.0.type=yastrebov"], "corrections.0.type", "yastrebov"),
        (["solver.tolerance=1e-5"], "solver.tolerance", 1e-5),
        (["outputs=[]"], "outputs", []),
        (["loading={}", "loading.force=1 N", "loading.force=2 N"], "loading.force", [2.0]),
    ],
)
def test_override(file: Path, changes: list[str], path: str, value: object) -> None:
    """``--set`` replaces a value, deep inside, in a list, or where there was none, in order.

    The mark that some editors put in front of a text is no error.
    """
    assert get(json.loads(pl.Run.from_toml(file, changes).to_json()), path) == value


@pytest.mark.parametrize("text", ["", "{", "[]", "1", "null"])
def test_not_json(text: str) -> None:
    """A text that is no JSON object is refused."""
    with pytest.raises(pl.ConfigError, match="JSON"):
        pl.Run.from_json(text)


STARTER: dict[str, Any] = tomllib.loads(
    files("pellicle").joinpath("examples/indent/indent.toml").read_text(encoding="utf-8")
)


def test_schema_allows_components_within_components() -> None:
    """A kernel that holds a kernel, itself one that holds a kernel, is as in a file."""
    inner: dict[str, Any] = {"type": "half_space", "reduced_modulus": "1 kPa"}
    for _ in range(2):
        inner = {"type": "coated", "tension": "1 mN/m", "substrate": inner}
    validator().validate(STARTER | {"kernel": inner})


@pytest.mark.parametrize(
    "change",
    [
        {"kernel": {"type": "nope"}},
        {"kernel": {"type": "half_space", "reduced_modulus": -1}},
        {"kernel": {"type": "coated", "substrate": {"type": "nope"}}},
        {"kernel": {"type": "coated", "substrate": {"type": "half_space", "reduced_modulus": -1}}},
        {"indenter": {"type": "paraboloid"}},
        {"indenter": {"type": "paraboloid", "radius": "1"}},
        {"grid": {"points": 16, "size": 1, "boundary": "open"}},
        {"loading": {"depth": []}},
        {"colour": "red"},
    ],
)
def test_schema_rejects(change: dict[str, Any]) -> None:
    """The JSON schema, too, refuses unknown types, keys and values."""
    assert not validator().is_valid(STARTER | change)


def test_library_raises_config_error() -> None:
    """From the library a bad input is a ConfigError, which is a ValueError and pickles."""
    with pytest.raises(pl.ConfigError) as caught:
        pl.Run()  # type: ignore[call-arg]
    assert isinstance(caught.value, ValueError)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_a_message_has_an_end() -> None:
    """Of 2000 unknown keys ten are told, and how many more; a path of 1e5 letters is cut."""
    with pytest.raises(pl.ConfigError) as raised:
        pl.Run(**BASE | {"grid": BASE["grid"] | {f"k{number}": 1 for number in range(2000)}})
    told = str(raised.value).splitlines()
    assert len(told) == 11
    assert told[-1] == "and 1990 more"
    assert len(raised.value.problems) == 2000
    with pytest.raises(pl.ConfigError) as raised:
        pl.Run(**BASE | {"k" * 100_000: 1})
    assert len(str(raised.value)) < 500
