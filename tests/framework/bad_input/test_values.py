"""A bad value or key: one message that names field, value, what is allowed and what to do."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import pellicle as pl
from pellicle import memory
from pellicle.config.scales import doubtful_scales
from tests.framework.bad_input.command_line import Cli, says

KEYS_AND_TYPES = {
    "unknown key": (
        "kernel.tensoin=1",
        ["kernel.tensoin: is not a field here", "did you mean 'tension'?", "reduced_modulus"],
    ),
    "unknown table": (
        "kernal.type='half_space'",
        ["kernal: is not a field here", "did you mean 'kernel'?", "indenter"],
    ),
    "key that Python knows": ("self=1", ["self: is not a field here", "kernel"]),
    "unknown type": (
        "kernel.type='tensed_membran'",
        ["kernel.type: 'tensed_membran' is not a kernel", "did you mean 'tensed_membrane'?"],
    ),
    "beginning of a type": (
        "kernel.type='tensed'",
        ["kernel.type: 'tensed' is not a kernel", "did you mean 'tensed_membrane'?"],
    ),
    "second prescription": (
        "loading.force='1 uN'",
        ["loading: prescribes depth and force", "--set loading=\"{force = '1 uN'}\""],
    ),
    "unknown type in a list": (
        "corrections.0.type='yastrebo'",
        ["corrections.0.type: 'yastrebo' is not a correction", "did you mean 'yastrebov'?"],
    ),
    "no type": ("kernel={}", ["kernel: has no type", "half_space", "tensed_membrane"]),
    "type is no text": ("kernel.type=1", ["kernel.type: 1 is not a kernel", "half_space"]),
    "choice": (
        "grid.boundary='perodic'",
        ["grid.boundary: 'perodic' is not allowed", "did you mean 'periodic'?", "free, periodic"],
    ),
    "choice in a list": (
        "outputs=[{type='figures', formats=['bmp']}]",
        ["outputs.0.formats.0: 'bmp' is not allowed", "pdf, png, svg"],
    ),
    "one output twice": (
        "outputs=[{type='csv'}, {type='hdf5'}, {type='csv'}]",
        ["outputs.2.type: 'csv' would write NAME.csv, as outputs.0 ('csv')", "leave one out"],
    ),
    "two outputs of one name": (
        "outputs=[{type='maps', name='a'}, {type='maps', name='b'}, {type='maps', name='a'}]",
        ["outputs.2.name: 'maps' would write NAME-a.png, as outputs.0", "give it another name"],
    ),
    "two outputs without a name": (
        "outputs=[{type='maps', field='gap'}, {type='maps', name='maps'}]",
        ["outputs.1.name: 'maps' would write NAME-maps.png, as outputs.0 ('maps') does"],
    ),
    "text wanted": ("title=1", ["title: 1 is not allowed; give text in quotes"]),
    "whole number wanted": (
        "solver.max_iterations='many'",
        ["solver.max_iterations: 'many' is not allowed; give a whole number"],
    ),
    "fraction of an iteration": (
        "solver.max_iterations=1.5",
        ["solver.max_iterations: 1.5 is not allowed; give a whole number"],
    ),
    "no iterations": ("solver.max_iterations=0", ["solver.max_iterations: 0", "give a value > 0"]),
    "negative seed": (
        "indenter={type='self_affine',rms_height=1,hurst=1,cutoff_wavelength=1,seed=-1}",
        ["indenter.seed: -1 is not allowed; give a value ≥ 0"],
    ),
    "file name wanted": (
        "indenter={type='heights', unit=1, path=1}",
        ["indenter.path: 1 is not allowed; give the name of a file"],
    ),
    "value where a table is wanted": ("loading=3", ["loading: 3 is not allowed; give a table"]),
    "value where a component is wanted": ("kernel=1", ["kernel: 1 is not a table", "half_space"]),
    "table where a list is wanted": (
        "corrections={type='yastrebov'}",
        ["corrections: {'type': 'yastrebov'} is not allowed; give a list"],
    ),
    "table where a quantity is wanted": (
        "kernel.tension={value=1}",
        ["kernel.tension: {'value': 1} is not a number", "'50 mN/m'"],
    ),
    "table where text is wanted": ("title={a=1}", ["title: {'a': 1}", "give text in quotes"]),
    "missing table": ("grid={}", ["grid.points: is missing", "grid.size: is missing", "[m]"]),
    "two moduli": (
        "kernel.youngs_modulus=1",
        ["kernel: reduced_modulus and youngs_modulus are both given", "give reduced_modulus alone"],
    ),
    "half a modulus": (
        "kernel={type='half_space', youngs_modulus=1}",
        ["kernel: no modulus", "give reduced_modulus, or both youngs_modulus and poissons_ratio"],
    ),
}


@pytest.mark.parametrize(("change", "words"), KEYS_AND_TYPES.values(), ids=KEYS_AND_TYPES)
def test_keys_and_types(refuse: Callable[..., str], change: str, words: list[str]) -> None:
    """A key or value of the wrong kind is named with what is allowed in its place."""
    says(refuse(change), *words)


QUANTITIES = {
    "grid.size": ("0 m", ["> 0 m", "'10 um'"]),
    "kernel.reduced_modulus": ("0 Pa", ["> 0 Pa", "'10 kPa'"]),
    "kernel.tension": ("-1 N/m", ["≥ 0 N/m", "'50 mN/m'"]),
    "indenter.radius": ("-1 mm", ["> 0 m", "'10 um'"]),
    "loading.depth": ("-1 um", ["≥ 0 m", "'10 um'"]),
}


@pytest.mark.parametrize(("field", "case"), QUANTITIES.items(), ids=QUANTITIES)
@pytest.mark.parametrize("bad", ["senseless", "nan", "inf", "-inf", "nan with a unit"])
def test_values_that_make_no_sense(
    refuse: Callable[..., str], field: str, case: tuple[str, list[str]], bad: str
) -> None:
    """NaN, infinity, and a negative or zero value where it means nothing are refused."""
    senseless, words = case
    unit = senseless.split()[1]
    value = {"senseless": f"'{senseless}'", "nan with a unit": f"'nan {unit}'"}.get(bad, bad)
    says(refuse(f"{field}={value}"), f"{field}: {value}", *words)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("force=-1", ["loading.force: -1 is not allowed", "≥ 0 N"]),
        ("force='1 m'", ["loading.force: '1 m' is a length, not a force", "'5 nN'"]),
        ("force=nan", ["loading.force: nan is not finite"]),
        ("mean_pressure=-1", ["loading.mean_pressure: -1 is not allowed", "≥ 0 Pa"]),
        ("mean_pressure=inf", ["loading.mean_pressure: inf is not finite"]),
    ],
)
def test_forces_and_pressures_that_make_no_sense(
    refuse: Callable[..., str], table: str, words: list[str]
) -> None:
    """Force and mean pressure are checked as depth is."""
    says(refuse("grid.boundary='periodic'", f"loading={{{table}}}"), *words)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("solver.tolerance=0", ["solver.tolerance: 0 is not allowed", "≥ 1e-13 and < 1"]),
        ("solver.tolerance='1 m'", ["solver.tolerance: '1 m' has a unit", "a plain number"]),
        (
            "kernel={type='half_space',youngs_modulus=1,poissons_ratio=0.6}",
            ["kernel.poissons_ratio: 0.6 is not allowed", "> -1 and ≤ 0.5"],
        ),
        (
            "indenter={type='cone',half_angle='95 degree'}",
            ["indenter.half_angle: '95 degree' is not allowed", "< 1.5708 rad", "'70 degree'"],
        ),
        (
            "indenter={type='self_affine',rms_height=1,hurst=1.1,cutoff_wavelength=1}",
            ["indenter.hurst: 1.1 is not allowed", "≥ 0 and ≤ 1"],
        ),
        (
            "kernel={type='layered',substrate='rigid',"
            "layers=[{youngs_modulus=1,poissons_ratio=0.5,thickness='0 um'}]}",
            ["kernel.layers.0.thickness: '0 um' is not allowed", "> 0 m", "'10 um'"],
        ),
        (f"grid.size={'9' * 400}", ["grid.size: 999", "is not finite"]),
    ],
)
def test_numbers_out_of_bounds(refuse: Callable[..., str], change: str, words: list[str]) -> None:
    """Angles, ratios and pure numbers state their bounds."""
    says(refuse(change), *words)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("'1 m'", ["'1 m' is a length, not a tension"]),
        ("'1 mN/n'", ["'1 mN/n' has an unknown unit ('mN/n')"]),
        ("'1 N/'", ["'1 N/' has an unknown unit ('N/')"]),
        ("'1'", ["'1' is text without a unit"]),
        ("'N/m'", ["'N/m' is not a number with a unit"]),
        ("''", ["'' is not a number with a unit"]),
        ("true", ["True is not a number"]),
        ("[1]", ["[1] is not a number"]),
    ],
)
def test_units(refuse: Callable[..., str], value: str, words: list[str]) -> None:
    """A wrong or missing unit is answered with the right one and an example."""
    message = refuse(f"kernel.tension={value}")
    says(message, f"kernel.tension: {words[0]}", "≥ 0 N/m", "such as '50 mN/m'")
    # In a shell a bare number is text, too.
    assert ("or a bare number in N/m" in message) is ("without a unit" not in words[0])


POINTS = {
    "none": ("0", ["grid.points: 0 is not allowed", "a whole number of cells ≥ 1"]),
    "negative": ("-1", ["grid.points: -1 is not allowed"]),
    "fraction": ("[16.5, 16]", ["grid.points.0: 16.5 is not allowed"]),
    "text": ("'16'", ["grid.points: '16' is not allowed"]),
    "one of two": ("[16]", ["grid.points.1: is missing", "[along x, along y]"]),
    "three": ("[1, 2, 3]", ["grid.points: [1, 2, 3]", "give a list of 2 or fewer"]),
    "too many": ("10_000_000", ["grid.points: 10000000 × 10000000 with 2 steps", "use fewer"]),
    "absurd": (f"1{'0' * 400}", ["grid.points: 1000", "needs about inf GB", "use fewer"]),
    "more digits than Python reads": ("9" * 5000, ["grid.points: '999", "is not allowed"]),
}


@pytest.mark.parametrize(("points", "words"), POINTS.values(), ids=POINTS)
def test_points(refuse: Callable[..., str], points: str, words: list[str]) -> None:
    """Numbers of cells that are senseless or do not fit in memory are refused before starting."""
    message = refuse(f"grid.points={points}")
    says(message, *words)
    assert len(message) < 400


def test_memory_is_estimated_before_starting(
    refuse: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A grid that needs more than there is left is refused with both numbers."""
    monkeypatch.setattr(memory, "available", lambda: 5e4)
    says(refuse(), "grid.points: 16 × 16 with 2 steps needs about", "5e-05 GB are available")


def test_memory_that_runs_out_all_the_same(
    refuse: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """An allocation that fails in spite of the estimate is no traceback."""

    def fail(*arguments: object) -> None:
        raise MemoryError

    monkeypatch.setattr("pellicle.runs.compose.make_operator", fail)
    says(refuse(), "grid.points: (16, 16) cells do not fit in memory; use fewer points")


def test_all_problems_at_once(refuse: Callable[..., str]) -> None:
    """Several problems are told together, a line each."""
    message = refuse("grid.points=0", "kernel.tension=-1", "loading={}", "kernel.colour=1")
    fields = [line.removeprefix("error: ").partition(":")[0] for line in message.splitlines()]
    assert sorted(fields) == ["grid.points", "kernel.colour", "kernel.tension", "loading"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("points", ["--set 'points' is not of the form a.b=value", "grid.points=128"]),
        ("=1", ["--set '=1' is not of the form a.b=value"]),
        ("grid..points=1", ["--set 'grid..points=1' is not of the form"]),
        ("title.text=1", ["title = 'bad input' is not a table", "replace it as a whole: title"]),
        ("grid.points.0=1", ["grid.points = 16 is not a table"]),
        ("corrections.1.type=1", ["corrections has no entry 1", "its 1, counted from 0"]),
        ("corrections.first.type=1", ["corrections has no entry first"]),
        ("mesh.points=1", ["mesh: is not a field here"]),
    ],
)
def test_set(refuse: Callable[..., str], change: str, words: list[str]) -> None:
    """An override that cannot be applied is quoted with the reason."""
    says(refuse(change), *words)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        (
            "cutoff_wavelength='30 um'",
            ["indenter.cutoff_wavelength: 30 µm cannot be resolved", "more grid.points"],
        ),
        (
            # So short that listing its modes would not fit in memory.
            "cutoff_wavelength='1 pm'",
            ["indenter.cutoff_wavelength: 1 pm cannot be resolved"],
        ),
        (
            "cutoff_wavelength='200 um', roll_off_wavelength='100 um'",
            ["indenter.roll_off_wavelength: 100 µm is shorter than cutoff_wavelength", "200 µm"],
        ),
        (
            "cutoff_wavelength='1 mm', roll_off_wavelength='2 mm'",
            ["indenter.roll_off_wavelength: no wavelength between", "widen the range"],
        ),
    ],
)
def test_spectrum(refuse: Callable[..., str], fields: str, words: list[str]) -> None:
    """A spectrum that the grid or the domain cannot hold is refused."""
    table = f"{{type='self_affine', rms_height='1 um', hurst=0.8, {fields}}}"
    says(refuse(f"indenter={table}"), *words)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "start.toml", "--threads", "0"], ["--threads"]),
        (["run", "start.toml", "--outptu", "x"], ["--outptu"]),
        (["run"], ["FILE"]),
        (["plot", "r.h5", "--format", "bmp"], ["bmp", "png", "svg", "pdf"]),
        (["rnu"], ["rnu"]),
    ],
)
def test_options(cli: Cli, arguments: list[str], words: list[str]) -> None:
    """A command or an option that does not exist is named."""
    outcome = cli(*arguments)
    assert outcome.exit_code == 2
    for word in words:
        assert word.lower() in outcome.message.lower()


COMMAND_LINES = {
    "choice": (
        ["plot", "x", "--format", "jpg"],
        "--format: 'jpg' is not one of 'png', 'svg', 'pdf'",
    ),
    "text for a number": (["explore", "--port", "foo"], "--port: 'foo' "),
    "number out of range": (["run", "x", "--threads", "0"], "--threads: "),
    "share beyond 1": (["check", "x", "--error", "5"], "--error: '5' is not allowed; give a perc"),
    "percentage beyond 50": (["check", "x", "--error", "60%"], "--error: '60%' is not allowed"),
    "missing argument": (["run"], "see `"),
    "unknown option": (["run", "x", "--foo"], "--foo; see `"),
    "option of the program": (["--foo"], "--foo; see `"),
    "unknown command": (["rnu"], "'rnu'"),
}


@pytest.mark.parametrize(("words", "message"), COMMAND_LINES.values(), ids=COMMAND_LINES)
def test_misused_command_line(cli: Cli, words: list[str], message: str) -> None:
    """A command line that cannot be read is answered in one line, in words of the user."""
    outcome = cli(*words)
    assert outcome.exit_code == 2
    assert outcome.message.startswith("error: ")
    assert outcome.message.count("\n") == 1
    says(outcome.message, message)
    assert "Value error" not in outcome.message


def test_size_without_a_unit(cli: Cli) -> None:
    """A domain of 200 m, a unit left out, is warned of before anything is solved."""
    outcome = cli("run", "start.toml", "--dry-run", "--set", "grid.size=200")
    assert outcome.exit_code == 0
    assert "200 m × 200 m" in outcome.stdout
    says(outcome.message, "warning: grid.size is 200 m", "'200 um'")
    assert cli("run", "start.toml", "--dry-run").message == ""


BEAD: dict[str, Any] = {
    "grid": {"points": 32, "size": "50 um"},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "4 kPa", "tension": "5 mN/m"},
    "indenter": {"type": "sphere", "radius": "20 um"},
    "loading": {"depth": "1 um"},
}


@pytest.mark.parametrize(
    ("table", "values", "message"),
    [
        ("kernel", {"tension": 50}, "kernel.tension is 50 N/m"),
        ("kernel", {"reduced_modulus": 4e-3}, "over the modulus 1.25 m"),
        ("indenter", {"radius": 20}, "indenter.radius is 20 m, on a domain of 50 µm"),
        ("loading", {"depth": 1}, "loading.depth is 1 m"),
        ("loading", {"depth": None, "force": 5}, "such as '5 nN'"),
        ("interaction", {"type": "jkr", "work_of_adhesion": 50}, "is 50 J/m²"),
    ],
)
def test_a_scale_that_lacks_a_unit(table: str, values: dict[str, Any], message: str) -> None:
    """A value out of scale with the others is doubted by name, and nothing else is."""
    changed = {**BEAD.get(table, {}), **values}
    given = {name: value for name, value in changed.items() if value is not None}
    ((path, text),) = doubtful_scales(pl.Run(**{**BEAD, table: given}))
    assert path.startswith(f"{table}." if table != "kernel" else "kernel.tension")
    assert message in text


@pytest.mark.parametrize("scale", [1.0, 1e-6])
def test_plausible_scales_are_not_doubted(scale: float) -> None:
    """Neither are those of a study without dimensions, in which all values are about 1."""
    run = pl.Run(
        grid={"points": 32, "size": 4 * scale},
        kernel={"type": "tensed_membrane", "reduced_modulus": 1, "tension": 2 * scale},
        indenter={"type": "paraboloid", "radius": 10 * scale},
        loading={"force": [0.1 * scale**2, scale**2]},
        interaction={"type": "jkr", "work_of_adhesion": scale},
    )
    assert [*doubtful_scales(run)] == []
    assert [*doubtful_scales(pl.Run(**BEAD))] == []
