"""Runs: from TOML, JSON and keywords, and back."""

from __future__ import annotations

import json
import pickle
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import pellicle as pl
from pellicle.cli.app import app
from pellicle.components import AreaCorrection, Output
from pellicle.plugins import registry

BASE: dict[str, Any] = {
    "grid": {"points": 16, "size": "1 mm"},
    "kernel": {"type": "half_space", "reduced_modulus": "10 kPa"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": "10 um"},
}
VARIANTS: dict[str, dict[str, Any]] = {
    "as little as possible": {},
    "title": {"title": 'quotes " and \\ and\nlines, \x7f, τ₀ and 🎈'},
    "rectangle": {"grid": {"points": [16, 24], "size": ["1 mm", 0.0015]}},
    "periodic": {
        "grid": {"points": 16, "size": "1 mm", "boundary": "periodic"},
        "loading": {"mean_pressure": ["1 Pa", "0.1 kPa"]},
    },
    "force": {"loading": {"force": "1 uN"}},
    "ramp": {"loading": {"depth": {"start": 0, "stop": "0.1 mm", "num": 7}}},
    "E and ν": {"kernel": {"type": "half_space", "youngs_modulus": "9 kPa", "poissons_ratio": 0.3}},
    "tension": {
        "kernel": {"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": "50 mN/m"}
    },
    "tension, E and ν": {
        "kernel": {
            "type": "tensed_membrane",
            "youngs_modulus": 9e3,
            "poissons_ratio": 0.5,
            "tension": 0,
        }
    },
    "quadric": {"indenter": {"type": "quadric", "radius_x": "1 mm", "radius_y": "3 mm"}},
    "sphere": {"indenter": {"type": "sphere", "radius": "1 mm"}},
    "cone": {"indenter": {"type": "cone", "half_angle": "70 degree"}},
    "flat punch": {"indenter": {"type": "flat_punch", "radius": "0.1 mm"}},
    "self-affine": {
        "indenter": {
            "type": "self_affine",
            "rms_height": "1 um",
            "hurst": 0.8,
            "cutoff_wavelength": "0.3 mm",
            "seed": 3,
        }
    },
    "solver": {"solver": {"type": "conjugate_gradient", "tolerance": 1e-6, "max_iterations": 7}},
    "corrections": {"corrections": [{"type": "yastrebov"}]},
    "no outputs": {"outputs": []},
    "outputs": {"outputs": [{"type": "csv"}, {"type": "figures", "formats": ["svg"]}]},
}


@cache
def validator() -> Draft202012Validator:
    """Return the validator of the JSON schema of a run file."""
    return Draft202012Validator(pl.schema())


def test_copy_with_other_values_has_these() -> None:
    """A copy forgets what had been computed of the values that it does not have."""
    loading = pl.Loading(depth=[1e-6, 2e-6])
    assert loading.values == (1e-6, 2e-6)
    assert loading.model_copy(update={"depth": (3e-6,)}).values == (3e-6,)
    assert loading.model_copy() == loading


def test_depths_of_numpy() -> None:
    """Arrays, numbers of numpy and −0 are taken; an array of one number is told that it is none."""
    assert pl.Loading(depth=np.array([1e-6, -0.0])).values == (1e-6, 0.0)
    assert str(pl.Loading(depth="-0 m").values[0]) == "0.0"
    ramp = {"start": np.float64(0), "stop": np.float64(2), "num": np.int64(3)}
    assert pl.Loading(depth=ramp).values == (0, 1, 2)
    with pytest.raises(pl.ConfigError, match="is not a number; give a value with its unit"):
        pl.Loading(depth=np.array(1e-6))


@pytest.mark.parametrize("variant", VARIANTS.values(), ids=list(VARIANTS))
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
    result_file = pl.Run(**BASE, outputs=[{"type": "hdf5"}])
    assert [output.suffixes for output in result_file.outputs or ()] == [()]
    assert pl.Run.from_json(result_file.to_json()) == result_file


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


@pytest.mark.parametrize(
    ("name", "given", "value"),
    [
        ("depth", "1 um", 1e-6),
        ("force", "1 uN", 1e-6),
        ("mean_pressure", "1 Pa", 1.0),
        ("mean_plane_depth", "-1 um", -1e-6),
        ("contact_radius", "1 um", 1e-6),
        ("contact_area", "1 mm^2", 1e-6),
    ],
)
def test_what_is_prescribed(name: str, given: str, value: float) -> None:
    """Each quantity has its unit, and is what the run as a file and the JSON schema say."""
    grid = BASE["grid"] | {"boundary": "periodic"}
    run = pl.Run(**(BASE | {"grid": grid, "loading": {name: [given], "stiffness": True}}))
    assert (run.loading.prescribed, run.loading.values) == (name, (value,))
    assert pl.Run.from_json(run.to_json()) == run
    validator().validate(json.loads(run.to_json()))
    ramp = {"start": given, "stop": 1.0, "num": 3, "back": True, "spacing": "linear"}
    validator().validate(json.loads(run.to_json()) | {"loading": {name: ramp}})


def test_ramp_ends_exactly() -> None:
    """The last step of a ramp is its stop, to the last bit."""
    for num in range(2, 50):
        values = pl.Loading(force={"start": 0.1, "stop": 0.7, "num": num}).values
        assert (values[0], values[-1], len(values)) == (0.1, 0.7, num)


@pytest.mark.parametrize(
    ("change", "path", "value"),
    [
        ("grid.points=8", ["grid", "points"], [8, 8]),
        ("grid.points = [8, 9]", ["grid", "points"], [8, 9]),
        ("kernel.reduced_modulus=5 kPa", ["kernel", "reduced_modulus"], 5e3),
        ('kernel.reduced_modulus="5 kPa"', ["kernel", "reduced_modulus"], 5e3),
        ("title=a = b", ["title"], "a = b"),
        ("corrections.0.type=yastrebov", ["corrections", 0, "type"], "yastrebov"),
        ("solver.tolerance=1e-5", ["solver", "tolerance"], 1e-5),
        ("outputs=[]", ["outputs"], []),
    ],
)
def test_override(tmp_path: Path, change: str, path: list[Any], value: object) -> None:
    """``--set`` replaces a value, deep inside, in a list, or where there was none."""
    file = tmp_path / "run.toml"
    file.write_text(pl.Run(**BASE, corrections=[{"type": "yastrebov"}]).to_toml(), encoding="utf-8")
    at = json.loads(pl.Run.from_toml(file, [change]).to_json())
    for name in path:
        at = at[name]
    assert at == value


def test_overrides_apply_in_order(tmp_path: Path) -> None:
    """A later override sees an earlier one."""
    file = tmp_path / "run.toml"
    file.write_text(pl.Run(**BASE).to_toml(), encoding="utf-8")
    run = pl.Run.from_toml(file, ["loading={}", "loading.force=1 N", "loading.force=2 N"])
    assert run.loading.values == (2.0,)


def test_byte_order_mark(tmp_path: Path) -> None:
    """The mark that some editors put in front of a text is no error."""
    file = tmp_path / "run.toml"
    file.write_text(pl.Run(**BASE).to_toml(), encoding="utf-8-sig")
    assert pl.Run.from_toml(file) == pl.Run(**BASE)


@pytest.mark.parametrize("text", ["", "{", "[]", "1", "null"])
def test_not_json(text: str) -> None:
    """A text that is no JSON object is refused."""
    with pytest.raises(pl.ConfigError, match="JSON"):
        pl.Run.from_json(text)


def _starter() -> dict[str, Any]:
    from importlib.resources import files

    return tomllib.loads(
        files("pellicle").joinpath("examples/indent/indent.toml").read_text(encoding="utf-8")
    )


def test_schema_is_one() -> None:
    """The JSON schema is itself valid and accepts the starter file."""
    Draft202012Validator.check_schema(pl.schema())
    validator().validate(_starter())


def test_schema_allows_components_within_components() -> None:
    """A kernel that holds a kernel, itself one that holds a kernel, is as in a file."""
    inner: dict[str, Any] = {"type": "half_space", "reduced_modulus": "1 kPa"}
    for _ in range(2):
        inner = {"type": "coated", "tension": "1 mN/m", "substrate": inner}
    validator().validate(_starter() | {"kernel": inner})


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
    assert not validator().is_valid(_starter() | change)


@pytest.mark.parametrize(
    "make",
    [
        lambda: pl.Grid(points=-1, size=1),
        lambda: pl.kernel("nope"),
        lambda: pl.indenter("sphere", radius=-1),
        lambda: pl.Run(),  # type: ignore[call-arg]
        lambda: pl.Loading(),
    ],
)
def test_library_raises_config_error(make: Any) -> None:
    """From the library a bad input is a ConfigError, which is a ValueError and pickles."""
    with pytest.raises(pl.ConfigError) as caught:
        make()
    assert isinstance(caught.value, ValueError)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_schema_command_is_the_library_s() -> None:
    """``pellicle schema`` prints what `schema` returns."""
    from typer.testing import CliRunner

    result = CliRunner().invoke(app, ["schema"])
    assert json.loads(result.stdout) == json.loads(json.dumps(pl.schema()))
