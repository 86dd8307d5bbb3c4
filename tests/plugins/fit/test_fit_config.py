"""Configurations of fits: a TOML file, keyword arguments and options make the same object."""

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import pellicle as pl
from pellicle_fit.problem import components_of
from tests.command import Cli
from tests.plugins.fit.test_many import save

OPTIONS: dict[str, Any] = {
    "indenter": "sphere",
    "poissons_ratio": 0.4,
    "model": ["tension", {"type": "drag", "drag": {"value": 0, "deviation": "1 mPa s"}}],
    "rivals": ["power_law", ["offset", "slope"], {"type": "layer", "thickness": "20 um"}],
    "fix": {"relaxation_exponent": 0.2},
    "uncertainty": {"spring_constant": "10 %", "radius": 0.03},
    "baseline": "offset",
    "spring_constant": "0.5 N/m",
    "executor": {"type": "processes", "workers": 1},
    "grid_points": 32,
}
BODY = """
poissons_ratio = 0.4
baseline = "offset"
spring_constant = "0.5 N/m"
grid_points = 32
model = ["tension", { type = "drag", drag = { value = 0, deviation = "1 mPa s" } }]
rivals = ["power_law", ["offset", "slope"], { type = "layer", thickness = "20 um" }]
fix = { relaxation_exponent = 0.2 }
uncertainty = { spring_constant = "10 %", radius = "3 %" }
executor = { type = "processes", workers = 1 }
"""
FILE = f'{BODY}\n[indenter]\ntype = "sphere"\nradius = "5 um"\n'


def measure(path: Path, radius: float = 5e-6) -> None:
    """Write a curve of a sphere on a solid of 2 kPa under 5 mN/m."""
    depth = np.linspace(-0.3, 1.0, 60) * 0.3 * radius
    sphere = pl.indenter("sphere", radius=radius)
    force = 2e3 * sphere.force_curve(depth, 5e-6).force  # type: ignore[attr-defined]
    force += 0.005 * force.max() * np.random.default_rng(60).standard_normal(60)
    save(path, depth, force)


def test_three_ways_make_one_object(tmp_path: Path) -> None:
    """The file, keyword arguments and texts of options give equal configurations."""
    (tmp_path / "bead.toml").write_text(FILE, encoding="utf-8")
    config = pl.FitConfig.from_toml(tmp_path / "bead.toml")
    assert config == pl.FitConfig.merged(None, radius="5 um", **OPTIONS)
    assert config == pl.FitConfig.merged(
        {"indenter": "cone"},
        ["fix.relaxation_exponent=0.2"],
        **OPTIONS | {"fix": None},
        radius=5e-6,
    )
    assert config == pl.FitConfig.from_json(config.to_json())
    (tmp_path / "again.toml").write_text(config.to_toml(), encoding="utf-8")
    assert config == pl.FitConfig.from_toml(tmp_path / "again.toml")
    assert config == pickle.loads(pickle.dumps(config))
    # Versions are recorded of whose components a fit uses, its effects among them.
    used = {component.__name__ for component in components_of(config)}
    assert {"Sphere", "Tension", "Drag", "PowerLaw", "Offset", "Slope", "Layer"} <= used


def test_a_diameter_is_two_radii(tmp_path: Path) -> None:
    """It stands wherever a radius may, in files, tables of files and arguments, but beside none."""
    config = pl.FitConfig.merged(indenter="sphere", radius="5 um")
    assert config == pl.FitConfig.merged(indenter="sphere", diameter="10 um")
    assert config == pl.FitConfig.merged({"indenter": {"type": "sphere", "diameter": 1e-5}})
    (tmp_path / "list.csv").write_text("file,diameter [um]\na.csv,8\n")
    measure(tmp_path / "a.csv")
    two = {"diameter": ["8 um", "8 um"]}
    for one in (
        pl.FitConfig.merged(config, curves=tmp_path / "list.csv"),
        pl.FitConfig.merged(config, curves=[tmp_path / "a.csv"] * 2, **two),
        pl.FitConfig.merged(config, curves=[tmp_path / "a.csv"] * 2, per_file=two),
    ):
        for source in one.sources():
            assert one.indenter_of(source) == pl.indenter("sphere", radius="4 um")
    with pytest.raises(pl.ConfigError, match="diameter"):
        pl.FitConfig.merged(indenter="sphere", radius="5 um", diameter="10 um")


def test_paths_start_from_the_folder_of_the_file(tmp_path: Path) -> None:
    """Curves, patterns and the cache are seen from the file, whatever its folder is called."""
    folder = tmp_path / "day [1]"
    for name in ("2.csv", "1.csv", "odd [3].csv", "table.toml"):
        measure(folder / name)
    names = '["?.csv", "odd [3].csv", "table.toml"]'
    text = f'curves = {names}\ncache = "studies"\nindenter = "cone"\n'
    (folder / "bead.toml").write_text(text, encoding="utf-8")
    config = pl.FitConfig.from_toml(folder / "bead.toml")
    read = [Path(source.name).name for source in config.sources()]
    assert read == ["1.csv", "2.csv", "odd [3].csv", "table.toml"]
    assert not any(isinstance(source.curve, Exception) for source in config.sources())
    assert config.cache == folder / "studies"


def test_options_replace_values_of_the_file(tmp_path: Path) -> None:
    """Options win over the file, and overrides over the options."""
    path = tmp_path / "bead.toml"
    path.write_text(f'curves = "nothing/*.csv"{FILE}', encoding="utf-8")
    options: dict[str, Any] = {"curves": "a.csv", "radius": "6 um", "baseline": "none"}
    config = pl.FitConfig.merged(path, ["indenter.radius=7 um"], **options)
    assert config.indenter == pl.indenter("sphere", radius="7 um")
    assert (config.baseline, config.curves) == ("none", (Path("a.csv"),))
    path.write_text(FILE, encoding="utf-8")
    config = pl.FitConfig.from_toml(path, ['indenter.type="paraboloid"'])
    changed = pl.FitConfig.merged(config, radius=["1 um", "2 um"], baseline="slope")
    assert changed.indenter == pl.indenter("paraboloid", radius="5 um")
    assert changed.per_file == {"radius": ("1 um", "2 um")}
    assert not pl.FitConfig.merged(changed, radius="3 um").per_file


@pytest.mark.slow
def test_options_of_the_question(cli: Cli) -> None:
    """Model, rivals, fixed quantities and uncertainties are given on the command line."""
    measure(Path("a.csv"))
    found = json.loads(
        cli(
            *("a.csv", "-i", "sphere", "--radius", "5 um", "--spring-constant", "0.5 N/m"),
            *("--model", "none", "--rivals", "offset,slope", "--rivals", "power_law"),
            *("--fix", "relaxation_exponent=0.1", "--fix", "reduced_modulus=6 kPa"),
            *("--uncertainty", "radius=3 %", "--uncertainty", "sensitivity=0.05", "--json"),
        ).stdout
    )
    # With this modulus the curve needs the first rival, which is of the instrument.
    assert found["baseline"] == ["offset", "slope"]
    assert sorted(e["effects"] for e in found["explanations"]) == [[], ["power_law"]]
    assert found["reduced_modulus"]["held"]
    (relaxing,) = (e for e in found["explanations"] if e["effects"] == ["power_law"])
    assert relaxing["parameters"]["relaxation_exponent"]["value"] == 0.1
    assert found["calibration"] == "calibration weighed: radius to 3 % and sensitivity to 5 %"
    configuration = found["configuration"]
    assert configuration["fix"] == {"relaxation_exponent": 0.1, "reduced_modulus": 6e3}
    assert configuration["uncertainty"] == {"radius": 0.03, "sensitivity": 0.05}


def test_none_is_a_list_without_effects() -> None:
    """What the command takes for no effect is one in Python and in files, too."""
    fields = {"curves": "a.csv", "indenter": "sphere", "radius": "5 um"}
    config = pl.FitConfig.merged(**fields, model="none", rivals="none")
    assert (config.model, config.rivals) == ((), ())


def test_schema() -> None:
    """The JSON schema accepts the file's tables and refuses unknown keys."""
    validator = Draft202012Validator(pl.FitConfig.model_json_schema())
    table = {"indenter": {"type": "sphere", "radius": "5 um"}, "curves": ["a.csv"]}
    assert validator.is_valid(table | {"spring_constant": "1 N/m", "baseline": "slope"})
    assert validator.is_valid(table | {"rivals": [[{"type": "power_law"}]], "model": []})
    assert not validator.is_valid(table | {"base": "slope"})
    assert not validator.is_valid(table | {"baseline": "cubic"})


def test_bad_arguments() -> None:
    """A configuration of several curves is not one for `fit`, nor has a force curve fields."""
    config = pl.FitConfig(indenter={"type": "sphere", "radius": "5 um"}, curves=["a", "b"])
    with pytest.raises(pl.ConfigError, match="names 2 curves; use fit_many"):
        pl.fit(config=config)
    with pytest.raises(pl.ConfigError, match="missing: indenter, "):
        pl.fit([1, 2], [1, 2])
