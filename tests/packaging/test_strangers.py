"""Strangers' packages, and such as ``pellicle new --plugin`` writes: built, installed, run."""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import pellicle as pl
from pellicle.cli.new import write_plugin
from pellicle.components.installed import FAMILIES as OWN

FAMILIES = *OWN, "effect", "reader"
HERE = Path(__file__).parent
CELLS = HERE.parent / "data" / "kernel_cells.csv"
GRADED, GEL, HOTTEST, RETRACT, SQUEEZE = (
    str(HERE / name)
    for name in (
        "third_party/graded.toml",
        "relaxing/dwell.toml",
        "one_output/hottest.toml",
        "quadratic_softening/retract.toml",
        "mean_gap/squeeze.toml",
    )
)
COMMAND_LINE = """
import json, os, sys
from typer.testing import CliRunner
from pellicle.cli.app import app

for line in sys.stdin:
    folder, arguments = json.loads(line)
    os.chdir(folder)
    done = CliRunner().invoke(app, arguments)
    print(json.dumps([done.exit_code, done.stdout, done.stderr]), flush=True)
"""
CONTRACTS = {
    "kernel": """
import pellicle as pl
from pellicle.testing import check_kernel
gel = pl.kernel("gel", reduced_modulus="10 kPa", time="1 s")
check_kernel(gel)
check_kernel(pl.kernel("coated", tension="50 mN/m", substrate=gel))
check_kernel(pl.kernel("sponge", reduced_modulus="10 kPa", diffusivity="1e-9 m^2/s"))
""",
    "output": """
from pellicle.testing import check_output
from pellicle_hottest import Hottest
check_output(Hottest())
""",
    "interaction": """
from pellicle.testing import check_interaction
from pellicle_quadratic_softening import QuadraticSoftening
check_interaction(QuadraticSoftening(work_of_adhesion="50 mJ/m^2", range="8 um"))
""",
    "prescription": """
from pellicle.testing import check_prescription
from pellicle_mean_gap import MeanGap
for share in (1.0, 0.5):
    check_prescription(MeanGap(share=share))
""",
    "effect": """
from pellicle_charged_gel.attraction import Attraction
from pellicle_charged_gel.stiffening import Stiffening
from pellicle_fit.testing import check_effect
check_effect(Attraction())
check_effect(Stiffening(power=2))
""",
}
ATTRACTED = """
import json, sys
import numpy as np
import pellicle as pl
depth = np.linspace(-0.6e-6, 0.8e-6, 160)
force = 4 / 3 * 2e3 * np.sqrt(5e-6) * depth.clip(0) ** 1.5
force -= 1.5e-10 * np.exp(depth.clip(None, 0) / 6e-8)
force += 1.2e-11 * np.random.default_rng(4).standard_normal(depth.size)
fit = pl.fit(depth, force, indenter="paraboloid", radius="5 um", rivals=sys.argv[1:])
print(fit.to_json())
"""
"""A curve of an attraction of 0.15 nN over 60 nm, fitted with rivals."""
Command = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return the folder of a written package of each family."""
    parent = tmp_path_factory.mktemp("written")
    return {family: write_plugin(family, f"my-{family}", parent) for family in FAMILIES}


@pytest.fixture(scope="module")
def environment(
    written: dict[str, Path], tmp_path_factory: pytest.TempPathFactory
) -> dict[str, str]:
    """Return the environment of processes in which all packages are installed."""
    site = tmp_path_factory.mktemp("site")
    install = [sys.executable, "-m", "pip", "install", "--no-deps", "--no-index", "--quiet"]
    sources = [path.parent for path in HERE.glob("*/pyproject.toml")]
    done = subprocess.run(
        [*install, "--no-build-isolation", f"--target={site}", *sources, *written.values()],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    inherited = {k: v for k, v in os.environ.items() if not k.startswith("PELLICLE_")}
    path = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])
    return inherited | {"PYTHONPATH": path, "PYTHONUTF8": "1"}


@pytest.fixture(scope="module")
def python(
    environment: dict[str, str], tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., str]:
    """Return a function that runs the interpreter of that environment, and what it prints."""

    def run(*arguments: str, **others: str) -> str:
        done = subprocess.run(
            [sys.executable, *arguments],
            env=environment | others,
            cwd=tmp_path_factory.mktemp("empty"),
            capture_output=True,
            encoding="utf-8",
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run


@contextmanager
def command_line(environment: dict[str, str], folder: Path) -> Iterator[Command]:
    """Yield the command ``pellicle`` of an environment, in a folder.

    All calls are in one process: loading the libraries takes twenty times as long as a command.
    """
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND_LINE],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        encoding="utf-8",
    )
    with process as server:
        assert server.stdin
        assert server.stdout
        answers, questions = server.stdout, server.stdin

        def run(*arguments: str, code: int = 0) -> subprocess.CompletedProcess[str]:
            questions.write(json.dumps([str(folder), arguments]) + "\n")
            questions.flush()
            done = subprocess.CompletedProcess(arguments, *json.loads(answers.readline()))
            assert done.returncode == code, done.stdout + done.stderr
            assert "Traceback" not in done.stderr
            return done

        yield run
        questions.close()
        assert server.wait(60) == 0


@pytest.fixture(scope="module")
def pellicle(
    environment: dict[str, str], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Command]:
    """Return the command ``pellicle`` of that environment."""
    with command_line(environment, tmp_path_factory.mktemp("empty")) as command:
        yield command


def test_are_listed_with_their_origin(pellicle: Command) -> None:
    """Each is found under its family with its distribution, its version and its first line."""
    listing = json.loads(pellicle("plugins", "--json").stdout)
    assert listing["broken"] == []
    assert {
        "family": "kernel",
        "type": "power_law",
        "origin": "pellicle-power-law",
        "version": "1.2.3",
        "description": "Stiffness k ∝ qⁿ: a Winkler foundation (n = 0), a graded solid, "
        "the half-space (n = 1).",
    } in listing["components"]
    assert {
        "family": "command",
        "type": "hertz",
        "origin": "pellicle-hertz",
        "version": "0.3.0",
        "description": "Print the force on a rigid sphere in an elastic half-space.",
    } in listing["components"]
    assert "Print the force on a rigid sphere" in pellicle("--help").stdout
    mine = [entry for entry in listing["components"] if entry["origin"].startswith("pellicle-my-")]
    assert {(entry["family"], entry["type"]) for entry in mine} == {
        (family, f"my_{family}") for family in FAMILIES
    }
    assert all(entry["description"].endswith((".", ").")) for entry in mine)


def test_are_in_the_schema(pellicle: Command) -> None:
    """An editor completes types, keys and fields; a command has a schema of its own."""
    schema = json.loads(pellicle("schema").stdout)
    (kernel,) = (
        k
        for k in schema["properties"]["kernel"]["oneOf"]
        if k["properties"]["type"]["const"] == "power_law"
    )
    assert {"reduced_modulus", "length", "exponent"} <= kernel["properties"].keys()
    law = schema["$defs"]["QuadraticSoftening"]["properties"]
    assert law.keys() == {"type", "work_of_adhesion", "range"}
    loadings = schema["$defs"]["Loading"]["oneOf"]
    (gap,) = (loading for loading in loadings if "mean_gap" in loading["properties"])
    assert gap["properties"].keys() == {"mean_gap", "share", "time", "stiffness"}
    hertz = json.loads(pellicle("schema", "hertz").stdout)
    assert hertz["required"] == ["radius", "reduced_modulus", "depth"]
    assert "Known: fit, hertz, run" in pellicle("schema", "check", code=2).stderr


@pytest.mark.slow
@pytest.mark.parametrize("family", CONTRACTS)
def test_keep_their_contract(family: str, python: Callable[..., str]) -> None:
    """The kit that checks our own has nothing to say: of a gel under a skin, of one method too."""
    python("-c", CONTRACTS[family])


def test_a_kernel_runs_and_is_on_record(pellicle: Command, tmp_path: Path) -> None:
    """Its file of nine lines runs to convergence, and the result names the distribution."""
    pellicle("run", GRADED, "-o", str(tmp_path))
    result = pl.load(tmp_path / "graded.h5")
    assert result.converged
    assert "pellicle-power-law 1.2.3" in result.dataset.attrs["versions"].split(", ")
    assert result.configuration["kernel"]["type"] == "power_law"


def test_a_membrane_known_by_its_symbol_has_the_reference_coefficients(
    python: Callable[..., str],
) -> None:
    """Installed and asked through the library, each of 27 coefficients is met to 1e-7."""
    errors = json.loads(python(str(HERE / "symbol_only" / "cells.py"), str(CELLS)))
    assert {float(s) for s in errors} >= {0.0, 0.1, 10.0}
    for of_length in errors.values():
        assert len(of_length) == 9
        assert max(map(abs, of_length)) < 1e-7


def test_a_kernel_that_relaxes_runs_in_time(pellicle: Command, tmp_path: Path) -> None:
    """The force at a depth is its modulus at each time."""
    pellicle("run", GEL, "-o", str(tmp_path))
    data = pl.load(tmp_path / "dwell.h5").dataset
    t, force = data["time"].values, data["force"].values
    modulus = 0.2 + 0.4 * np.exp(-t / 0.5) + 0.4 * np.exp(-t / 5)
    np.testing.assert_allclose(force / force[0], modulus, rtol=1e-7)


@pytest.mark.parametrize("studied", [False, True])
def test_an_output_shows_a_run_and_a_study(
    studied: bool, pellicle: Command, tmp_path: Path
) -> None:
    """Its file has the highest pressure of each step, beside the result and nothing else."""
    vary = ["--set", 'study.vary={"kernel.tension" = ["0.1 N/m", "0.2 N/m"]}'] if studied else []
    pellicle("run", HOTTEST, *vary, "-o", str(tmp_path))
    name = "study" if studied else "hottest"
    files = {path.name for path in tmp_path.iterdir()} - {"runs", "study.csv"}
    assert files == {f"{name}.h5", f"{name}-hottest.txt"}
    runs = sorted(tmp_path.glob("runs/*.h5")) if studied else [tmp_path / "hottest.h5"]
    highest = {x for run in runs for x in pl.load(run).dataset["pressure"].max(["x", "y"]).values}
    lines = (tmp_path / f"{name}-hottest.txt").read_text().split()
    assert len(lines) == (4 if studied else 2)
    assert {float(line) for line in lines} == highest


def test_a_law_of_adhesion_runs_and_is_on_record(pellicle: Command, tmp_path: Path) -> None:
    """Its file runs from contact to out of reach; the result has its law and its distribution."""
    pellicle("run", RETRACT, "-o", str(tmp_path), "--set", "outputs=[{type='csv'}]")
    result = pl.load(tmp_path / "retract.h5")
    assert result.converged
    assert result.configuration["interaction"]["range"] == 8e-6
    versions = result.dataset.attrs["versions"].split(", ")
    assert "pellicle-quadratic-softening 0.2.0" in versions
    data = result.dataset.isel(step=1)
    assert data["force"] < 0 < data["zone_area"]
    # The traction is the wall pressure and the law at the gap, by its formula and not by its code.
    law = -3 * 0.05 / 8e-6 * np.clip(1 - data["gap"] / 8e-6, 0, 1) ** 2
    np.testing.assert_allclose(
        data["pressure"], data["wall_pressure"] + law, atol=1e-5 * float(abs(law).max())
    )
    assert not result.dataset["pressure"][2].any()
    assert "residual_traction" in (tmp_path / "retract.csv").read_text(encoding="utf-8")


def test_a_prescription_runs_and_is_on_record(pellicle: Command, tmp_path: Path) -> None:
    """Its file runs to the gaps prescribed; the result names the distribution; a rerun resumes."""
    run = ("run", SQUEEZE, "-o", str(tmp_path), "--set", "outputs=[]")
    pellicle(*run)
    result = pl.load(tmp_path / "squeeze.h5")
    assert result.converged
    assert result.configuration["loading"]["share"] == 0.5
    assert "pellicle-mean-gap 0.3.0" in result.dataset.attrs["versions"].split(", ")
    np.testing.assert_allclose(result.dataset["mean_gap"], [1.5e-5, 1e-5, 5e-6], rtol=1e-6)
    inner = result.dataset["gap"][:, 8:24, 8:24].mean(["x", "y"])
    np.testing.assert_allclose(inner, result.dataset["mean_gap"], rtol=1e-12)
    assert result.dataset["mean_gap"].attrs["units"] == "m"
    pellicle(*run)
    assert "mean gap [µm]" in pellicle("show", str(tmp_path / "squeeze.h5")).stdout


@pytest.mark.slow
def test_an_effect_is_weighed_when_it_is_named(python: Callable[..., str]) -> None:
    """Installed but not named it changes nothing; named it explains what the others do not."""
    bare = python("-c", ATTRACTED, "offset", PELLICLE_DISABLE_PLUGINS="1")
    answers = [json.loads(bare), json.loads(python("-c", ATTRACTED, "offset"))]
    for answer in answers:
        for passing in ("date", "wall_time"):
            answer.pop(passing, None)
    assert answers[0] == answers[1]
    named = json.loads(python("-c", ATTRACTED, "offset", "attraction", "stiffening"))
    assert named["model"]["effects"] == ["attraction"]
    found = named["parameters"]
    for name, truth in (("reduced_modulus", 2e3), ("attraction", 1.5e-10)):
        assert found[name]["low"] <= truth <= found[name]["high"]
    compared = [set(explanation["effects"]) for explanation in named["explanations"]]
    assert {"stiffening"} in compared
    assert {"attraction", "tension"} in compared


@pytest.mark.parametrize(
    ("file", "change", "words"),
    [
        (GRADED, "kernel.exponent=3", "error: kernel.exponent: 3 is not allowed"),
        (RETRACT, "interaction.range='50 mJ'", "interaction.range: '50 mJ' is in mJ"),
        (RETRACT, "interaction.rang=1", "interaction.rang: is not a field here; did you mean"),
        (
            SQUEEZE,
            "loading={mean_gap='-1 um'}",
            "loading.mean_gap: '-1 um' is not allowed; give a value ≥ 0 m",
        ),
        (SQUEEZE, "loading={mean_gap='1 um', share=2}", "loading.share: 2 is not allowed"),
        (SQUEEZE, "loading={mean_gop='1 um'}", "did you mean 'mean_gap'"),
    ],
)
def test_bad_values_are_refused_like_our_own(
    pellicle: Command, file: str, change: str, words: str
) -> None:
    """Fields and keys of a stranger are checked, and the message names them."""
    assert words in pellicle("run", file, "--set", change, code=2).stderr


def test_the_file_of_a_command_runs_and_explains_itself(pellicle: Command, tmp_path: Path) -> None:
    """The example is found in its package, and what is beside it is named after it."""
    file = tmp_path / "mine.toml"
    done = pellicle("new", "--example", "bead", str(file))
    assert done.stdout == f"wrote {file}; next: pellicle hertz {file}\n"
    assert {path.name for path in tmp_path.iterdir()} == {"mine.toml", "mine-image.txt"}
    assert "measured in mine-image.txt" in file.read_text(encoding="utf-8")
    # 4/3 · 2 kPa · √(5 µm) · (0.5 µm)^(3/2)
    assert pellicle("hertz", str(file)).stdout == "2.108 nN\n"
    shown = pellicle("explain", "hertz").stdout
    assert 'radius = "5 um"\nreduced_modulus = "2 kPa"\ndepth = "0.5 um"\n' in shown
    assert {"radius", "reduced_modulus", "depth"} == {
        line.split()[0] for line in shown.splitlines() if " required " in line
    }


def test_a_file_for_another_command_is_told_so(pellicle: Command, tmp_path: Path) -> None:
    """Both ways, between a stranger's command and ours."""
    for example, wrong, right in (("bead", "run", "hertz"), ("layer", "hertz", "run")):
        file = tmp_path / f"{example}.toml"
        pellicle("new", "--example", example, str(file))
        done = pellicle(wrong, str(file), code=2)
        assert f"makes this a file for `pellicle {right}`" in done.stderr
        assert len(done.stderr.splitlines()) == 1


@pytest.mark.slow
def test_can_be_switched_off(
    pellicle: Command, environment: dict[str, str], tmp_path: Path
) -> None:
    """A file says what is switched off and by what, a command is not found, results are shown."""
    pellicle("run", SQUEEZE, "-o", str(tmp_path), "--set", "outputs=[]")
    with command_line(environment | {"PELLICLE_DISABLE_PLUGINS": "1"}, tmp_path) as without:
        said = without("run", GRADED, code=2).stderr
        assert "pellicle-power-law 1.2.3" in said
        assert "switched off by PELLICLE_DISABLE_PLUGINS" in said
        assert "No such command 'hertz'" in without("hertz", code=2).stderr
        listed = json.loads(without("plugins", "--json").stdout)["disabled"]
        assert "pellicle-hertz 0.3.0 (entry point 'command.hertz')" in listed
        without("show", "squeeze.h5")


@pytest.mark.slow
def test_written_packages_pass_their_own_tests(
    written: dict[str, Path], python: Callable[..., str]
) -> None:
    """As they stand, without a change, with warnings as errors."""
    strict = ["-W", "error", "-p", "no:cacheprovider", "--import-mode=importlib"]
    shown = python("-m", "pytest", "-q", "-rA", *strict, *map(str, written.values()))
    for family in FAMILIES:
        assert f"test_pellicle_my_{family}.py::test_keeps_its_contract" in shown


@pytest.mark.parametrize(
    "family",
    [
        family if family in ("kernel", "output") else pytest.param(family, marks=pytest.mark.slow)
        for family in FAMILIES
    ],
)
def test_example_of_a_written_package_runs(
    family: str, written: dict[str, Path], pellicle: Command, tmp_path: Path
) -> None:
    """It converges, with the component in its place, and no placeholder is left in any file."""
    command = "fit" if family in ("effect", "reader") else "run"
    done = pellicle(command, str(written[family] / f"my_{family}.toml"), "-o", str(tmp_path))
    assert any(tmp_path.iterdir())
    told = {"effect": "double-layer repulsion", "reader": "modulus"}.get(family, "")
    assert told in done.stdout
    files = list(written[family].iterdir())
    assert len(files) == 5 + (command == "fit")
    for file in files:
        assert "$" not in file.read_text(encoding="utf-8").replace("\n$ ", "\n"), file
