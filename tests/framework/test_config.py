"""Runs from TOML, JSON and keywords, and back; paths in legs; files to read and their encodings."""

import base64
import hashlib
import json
import pickle
import re
import shutil
import tomllib
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from typer.testing import CliRunner

import pellicle as pl
from pellicle.cli.app import app
from pellicle.components import AreaCorrection, Output
from pellicle.components.installed import registry
from pellicle.components.prescription import OPTIONS
from pellicle.config.loading import Options
from pellicle.files import read_text
from pellicle.schema import InputPath, Model, get
from pellicle.schema.from_file import read_toml
from pellicle_fit.files.choice import read as read_curves
from tests.command import call
from tests.tables_of_runs import half_space, paraboloid, pressing, relaxing

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


LEGS: list[dict[str, Any]] = [
    {"to": "1 um", "time": "1 s", "num": 4},
    {"hold": "5 s", "num": 2},
    {"amplitude": "10 nm", "frequency": "0.5 Hz", "cycles": 2, "num": 4},
]
LEGS_RUN: dict[str, Any] = {
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
            pl.Run(**{**LEGS_RUN, "loading": {name: legs}})
        pl.Run(**{**LEGS_RUN, "kernel": LEGS_RUN["kernel"]["solid"], "loading": {name: legs}})
    pl.Run(**{**LEGS_RUN, "loading": {name: [jump, slow]}})


def test_time_of_nought_is_a_jump() -> None:
    """All steps of such a leg have one time."""
    loading = pl.Loading(force=[{"to": 2.0, "time": 0, "num": 2}, {"hold": 1, "num": 1}])
    assert loading.values == (1.0, 2.0, 2.0)
    assert loading.times == (0.0, 0.0, 1.0)


def test_a_run_with_legs_is_one_in_every_form() -> None:
    """JSON, TOML, a pickle and a copy of its parts describe the same run, which the schema takes.

    The schema refuses legs that mix keys.
    """
    run = pl.Run(**LEGS_RUN)
    assert pl.Run.from_json(run.to_json()) == run
    assert pickle.loads(pickle.dumps(run)) == run
    assert pl.Run(**{name: getattr(run, name) for name in run.model_fields_set}) == run
    configuration = json.loads(run.to_json())
    validator = Draft202012Validator(pl.json_schema())
    validator.validate(configuration)
    validator.validate({**configuration, "loading": {"depth": LEGS}})
    configuration["loading"]["depth"][1]["frequency"] = 1.0
    assert not validator.is_valid(configuration)
    assert run.identity != pl.Run(**{**LEGS_RUN, "loading": {"depth": LEGS[:2]}}).identity


def test_the_first_leg_is_no_jump() -> None:
    """Under a flat punch pressed in at a constant speed F(t)/F₀ = ∫ E(t − t′) dt′, from 0 s on."""
    data = pl.run(LEGS_RUN, progress=False).dataset
    t, force = data["time"].values[:4], data["force"].values[:4]
    growth = 0.2 * t + 0.8 * 2 * -np.expm1(-t / 2)
    at_once = {**LEGS_RUN, "loading": {"depth": "1 um", "time": 0}}
    stiffness = pl.run(at_once, progress=False).dataset["force"].item()
    np.testing.assert_allclose(force, stiffness * growth, rtol=1e-8)


def test_legs_at_the_command_line(tmp_path: Path) -> None:
    """Values of legs can be set; the plan counts their steps, the listing shows their times."""
    file, folder = tmp_path / "legs.toml", tmp_path / "out"
    file.write_text(pl.Run(**LEGS_RUN).to_toml(), encoding="utf-8")
    command = ["run", str(file), "-o", str(folder), "--set", "loading.depth.2.cycles=1"]
    assert " 10 " in call(*command, "--dry-run").output
    call(*command)
    result = pl.load(folder / "legs.h5")
    assert result.planned_steps == result.dataset.sizes["step"] == 10
    shown = call("show", folder / "legs.h5").output
    head = next(line for line in shown.splitlines() if line.startswith("step"))
    assert head.split()[:5] == ["step", "time", "[s]", "depth", "[µm]"]


@pytest.mark.parametrize("run", [LEGS_RUN, pl.Run(**LEGS_RUN)], ids=["mapping", "run"])
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


HEIGHTS = 1e-1 * np.add.outer(np.arange(8.0), np.arange(8.0) ** 2)
FILE = """
outputs = [{ type = "html" }]
grid = { points = 8, size = "0.4 mm" }
kernel = { type = "half_space", reduced_modulus = "10 kPa" }
indenter = { type = "heights", path = "../data/a.npy", unit = "1 um" }
loading = { depth = "30 um" }
"""


class InputFile(Model):
    """A model with a file."""

    path: InputPath


VARY = '[study]\nvary = { "indenter.path" = ["../data/a.npy", "../data/b.npy"] }\n'


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Return a folder with a run file, a study file, and heights beside them."""
    root = tmp_path / "home-of-somebody" / "project"
    for name in ("data", "runs"):
        (root / name).mkdir(parents=True)
    np.save(root / "data" / "a.npy", HEIGHTS)
    np.save(root / "data" / "b.npy", 2 * HEIGHTS)
    (root / "runs" / "a.toml").write_text(FILE, encoding="utf-8")
    (root / "runs" / "s.toml").write_text(FILE + VARY, encoding="utf-8")
    return root


def _saved(page: Path) -> str:
    """Return the file that a page offers to reproduce it."""
    texts = re.findall(r"data:text/plain;charset=utf-8;base64,([^\"]*)", page.read_text("utf-8"))
    return base64.b64decode(texts[0]).decode()


def test_page_of_a_run_can_be_given_away(project: Path, tmp_path: Path) -> None:
    """It has the name and the hash of the heights, and nothing of the machine."""
    first = pl.Run.from_toml(project / "runs" / "a.toml")
    pl.run(first, directory=tmp_path / "out", progress=False)
    text = (tmp_path / "out" / "run.html").read_text(encoding="utf-8")
    assert "home-of-somebody" not in text
    assert hashlib.sha256(HEIGHTS.tobytes()).hexdigest() in text

    elsewhere = tmp_path / "elsewhere"
    shutil.copytree(project / "data", elsewhere)
    again = elsewhere / "again.toml"
    again.write_text(_saved(tmp_path / "out" / "run.html"), encoding="utf-8")
    assert "home-of-somebody" not in again.read_text(encoding="utf-8")
    assert pl.Run.from_toml(again).identity == first.identity
    np.save(elsewhere / "a.npy", HEIGHTS[::-1])
    with pytest.raises(pl.ConfigError, match=r"^indenter\.sha256: .*they have changed"):
        pl.Run.from_toml(again)


def test_page_of_a_study_can_be_given_away(project: Path, tmp_path: Path) -> None:
    """The values of an axis are as they were given, in the page and in the table."""
    table = pl.run_study(project / "runs" / "s.toml", tmp_path / "out", progress=False)
    given = ["../data/a.npy", "../data/b.npy"]
    assert list(table["indenter.path"].values) == given
    page = tmp_path / "out" / "study.html"
    assert "home-of-somebody" not in page.read_text(encoding="utf-8")
    assert "home-of-somebody" not in (tmp_path / "out" / "study.csv").read_text(encoding="utf-8")
    assert tomllib.loads(_saved(page))["study"]["vary"]["indenter.path"] == given


def test_given_paths_mean_the_same_from_anywhere(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Objects and copies have the place of the file; only texts to give away do not."""
    monkeypatch.chdir("/")
    run = pl.Run.from_toml(project / "runs" / "a.toml")
    file = project / "runs" / "../data/a.npy"
    (project / "toml.toml").write_text(run.to_toml(), encoding="utf-8")
    copies = pickle.loads(pickle.dumps(run)), pl.Run.from_json(run.to_json())
    for copy in (run, *copies, pl.Run.from_toml(project / "toml.toml")):
        assert copy.indentation.indenter.model_dump()["path"] == file
        assert copy == run
    assert json.loads(run.to_json())["indenter"]["path"] == str(file)
    assert json.loads(run.to_json(portable=True))["indenter"]["path"] == "a.npy"
    assert InputFile(path="a/b.npy").path == Path("a/b.npy")
    study = pl.Study.from_toml(project / "runs" / "s.toml")
    paths = [point.run.indentation.indenter.model_dump()["path"] for point in study.points]
    assert [path.name for path in paths] == ["a.npy", "b.npy"]
    again = pl.Study.from_json(study.to_json())
    assert [point.run for point in again.points] == [point.run for point in study.points]
    assert study.points[0].run.identity != study.points[1].run.identity


CURVE = "position (µm),force (nN)\n0,0\n1,2\n2,5\n"
OF_ENCODINGS = "# heights, µm\n1 2\n3 4\n"
CODE_PAGES = ("cp1252", "cp437", "ascii", "utf-8")


@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
def test_what_a_code_page_lacks_is_replaced(encoding: str) -> None:
    """Help ends without an error, and so does a message that has a name of other signs."""
    for words in (["--help"], ["run", "--help"]):
        assert CliRunner(charset=encoding).invoke(app, words).exit_code == 0
    refused = CliRunner(charset=encoding).invoke(app, ["run", "Δ接触.toml"])
    assert refused.exit_code == 2
    assert ".toml: No such file" in refused.stderr


@pytest.mark.parametrize("encoding", CODE_PAGES)
@pytest.mark.parametrize("words", [["schema"], ["plugins", "--json"]])
def test_json_is_ascii(encoding: str, words: list[str]) -> None:
    """JSON is printed in ASCII, and so reads the same in whatever code page it went through."""
    printed = CliRunner(charset=encoding).invoke(app, words)
    assert printed.exit_code == 0, printed.exception
    assert printed.stdout_bytes.isascii()
    assert json.loads(printed.stdout_bytes) == json.loads(call(*words).stdout)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_tables_are_read_in_the_encodings_of_instruments(encoding: str, tmp_path: Path) -> None:
    """A curve or heights with µ in them are the same in Unicode and in Windows' code page."""
    curve, heights = tmp_path / "a.csv", tmp_path / "a.txt"
    curve.write_bytes(CURVE.encode(encoding))
    heights.write_bytes(OF_ENCODINGS.encode(encoding))
    (reader,) = read_curves(curve).values()
    np.testing.assert_allclose(reader().position, [0, 1e-6, 2e-6])
    indenter = pl.indenter("heights", path=heights, unit="1 um")
    profile = indenter.profile(*pl.Grid(points=2, size=1.0).coordinates())
    np.testing.assert_allclose(profile, [[-3e-6, -2e-6], [-1e-6, 0]])


def test_bytes_are_not_text(tmp_path: Path) -> None:
    """What has zero bytes, or bytes that no encoding here has, is refused as text."""
    path = tmp_path / "a.txt"
    for content in (b"1 2\0\n", b"\x81\x8d", "1 2".encode("utf-16-le"), b"\xff\xfe1"):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=r"."):
            read_text(path)
        with pytest.raises(pl.ConfigError, match=r"^path: .* cannot be read as text"):
            pl.indenter("heights", path=path, unit=1)


@pytest.mark.parametrize("encoding", ["cp1252", "utf-16"])
def test_toml_in_another_encoding(encoding: str, tmp_path: Path) -> None:
    """TOML is UTF-8: the message says so, and where the file is not."""
    path = tmp_path / "a.toml"
    path.write_bytes("a = 1\ntitle = 'µ'\n".encode(encoding))
    line = 2 if encoding == "cp1252" else 1
    with pytest.raises(pl.ConfigError, match=rf"not a text file in UTF-8 \(see line {line}\)"):
        read_toml(path)
    path.write_bytes("a = 1\ntitle = 'µ'\n".encode("utf-8-sig"))
    assert read_toml(path) == {"a": 1, "title": "µ"}
