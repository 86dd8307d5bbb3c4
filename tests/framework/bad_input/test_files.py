"""Files that cannot be written, loads not attained, runs interrupted: nothing solved is lost."""

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import pellicle as pl
from tests.command import Cli, call
from tests.framework.bad_input.conftest import says
from tests.framework.sentences.bad_files import START


@pytest.mark.parametrize("type_", ["csv", "figures"])
def test_output_folder_that_cannot_be_written(
    cli: Cli, monkeypatch: pytest.MonkeyPatch, type_: str
) -> None:
    """A file where the output folder should be is found out before anything is solved."""
    Path("out").write_text("in the way", encoding="utf-8")

    def fail(*arguments: object) -> None:
        raise AssertionError("solved in vain")

    monkeypatch.setattr("pellicle.runs.solve.solve_step", fail)
    outputs = f"outputs=[{{type='{type_}'}}]"
    outcome = cli("run", "start.toml", "-o", "out", "--set", outputs, code=2)
    says(outcome.stderr, "out/start", "cannot be written", "choose another folder")
    assert Path("out").read_text(encoding="utf-8") == "in the way"


def test_result_of_another_configuration(cli: Cli) -> None:
    """A result is replaced by that of another configuration only when asked."""
    cli("run", "start.toml", "-o", "out")
    before = Path("out/start.h5").read_bytes()
    other = ["run", "start.toml", "-o", "out", "--set", "loading.depth='5 um'"]
    outcome = cli(*other, code=2)
    says(outcome.stderr, "out/start.h5 holds the result of another configuration", "--overwrite")
    assert Path("out/start.h5").read_bytes() == before
    cli(*other, "--overwrite")
    assert pl.load("out/start.h5").dataset["depth"].values == pytest.approx([5e-6])


def test_figures_that_cannot_be_written(cli: Cli) -> None:
    """A file in place of the folder for figures is named."""
    cli("run", "start.toml", "-o", "out", "--quiet")
    outcome = cli("plot", "out/start.h5", "-o", "start.toml", code=2)
    says(outcome.stderr, "start.toml/start-pressure.png: cannot be written", "another folder")


def test_area_of_few_cells(cli: Cli) -> None:
    """An area that no number of whole cells comes near to is marked, one they nearly have said."""
    loading = "loading={contact_area=['4.7e-9 m**2', '4.6e-8 m**2']}"
    outcome = cli("run", "start.toml", "-o", "out", "--set", loading, code=1)
    says(outcome.stderr, "step 1 did not converge: the contact area misses", "use more points")
    says(outcome.stderr, "step 2: converged; the contact area misses", "nearer number of whole")
    kept = pl.load("out/start.h5").dataset
    assert kept["converged"].values.tolist() == [False, True]


@pytest.mark.parametrize(
    ("loading", "boundary", "named"),
    [
        ("{depth='1 mm'}", "free", "loading.depth = 1 mm"),
        ("{force='1 N'}", "free", "loading.force = 1 N"),
        ("{contact_area='0.19 mm**2'}", "free", "loading.contact_area = 0.19 mm²"),
        ("{mean_pressure='1 MPa'}", "periodic", "loading.mean_pressure = 1 MPa"),
    ],
)
def test_contact_reaches_the_edge(cli: Cli, loading: str, boundary: str, named: str) -> None:
    """A load beyond the domain's reach leaves a result that is marked, and exit code 1."""
    changes = ["--set", f"loading={loading}", "--set", f"grid.boundary='{boundary}'"]
    outcome = cli("run", "start.toml", "-o", "out", *changes, code=1)
    says(outcome.stderr, "step 1 did not converge", "reaches the edge", named)
    says(outcome.stderr, "enlarge grid.size = 447.2 µm × 447.2 µm or press in less far")
    kept = pl.load("out/start.h5").dataset
    assert not kept["converged"].item()
    assert "reaches the edge" in kept["status"].item()
    assert "NOT CONVERGED" in outcome.stdout


# Where tests run in the background, their processes would ignore Ctrl-C.
LISTENING = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from pellicle.__main__ import main; main()"
)


@pytest.fixture
def long_run(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """Return a process that has written its first step and has many to go."""
    (tmp_path / "start.toml").write_text(START, encoding="utf-8")
    steps = "loading.depth={start='10 um', stop='20 um', num=20_000}"
    process = subprocess.Popen(
        [sys.executable, "-c", LISTENING, "run", "start.toml", "-o", "out", "--set", steps],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        patience = time.monotonic() + 60
        while not (tmp_path / "out/start.h5").exists():
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < patience, "no step in a minute"
            time.sleep(0.01)
        yield process
    finally:
        process.kill()
        process.communicate()


@pytest.mark.slow
def test_interrupt(tmp_path: Path, long_run: subprocess.Popen[str]) -> None:
    """Ctrl-C leaves every finished step, says where, and exits with 130."""
    long_run.send_signal(signal.SIGINT)
    message = long_run.communicate(timeout=60)[1]
    assert long_run.returncode == 130
    says(message, "interrupted; finished steps are in out")
    assert "Traceback" not in message
    done = pl.load(tmp_path / "out/start.h5").dataset
    assert 1 <= done.sizes["step"] < 20_000
    assert done["converged"].values.all()
    shown = call("show", tmp_path / "out/start.h5", code=1)
    assert f"interrupted: {done.sizes['step']} of 20000 steps" in shown.stderr
