"""What kit and run say of broken components, alone and together, and what only looks broken."""

from __future__ import annotations

import warnings
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle import testing
from pellicle.components import Variable
from pellicle.components.installed import registry
from pellicle.components.rules import CHEAP
from pellicle.plugins.registry import checked_type
from pellicle.testing import component as component_rules
from pellicle.testing import executors
from pellicle.testing.component import RULES, rules_of
from tests.framework.broken.catalogue import GRID, PARTS, RULE, Broken, Refused, Taken, make, run
from tests.framework.broken.corrections import CORRECTIONS, Correction
from tests.framework.broken.executors import EXECUTORS, Executor
from tests.framework.broken.general import GENERAL, TwoFaced
from tests.framework.broken.indenters import INDENTERS
from tests.framework.broken.interactions import INTERACTIONS
from tests.framework.broken.kernels import KERNELS, Kernel, Relaxing
from tests.framework.broken.outputs import OUTPUTS, Output
from tests.framework.broken.prescriptions import PRESCRIPTIONS, Volume
from tests.framework.broken.solvers import SOLVERS, Solver

# The rules of all components are checked on indenters.
FAMILIES = {
    "component": GENERAL,
    "correction": CORRECTIONS,
    "executor": EXECUTORS,
    "indenter": INDENTERS,
    "interaction": INTERACTIONS,
    "kernel": KERNELS,
    "output": OUTPUTS,
    "prescription": PRESCRIPTIONS,
    "solver": SOLVERS,
}
ALL = [
    (name, rule, broken)
    for name, family in FAMILIES.items()
    for rule, several in family.broken.items()
    for broken in (several if isinstance(several, list) else [several])
]
each_family = pytest.mark.parametrize("name", FAMILIES)
each_broken = pytest.mark.parametrize(
    ("name", "rule", "broken"), ALL, ids=[f"{name}: {broken.fault}" for name, _, broken in ALL]
)


def kit_says(family: str, component: object) -> list[str]:
    """Return the lines of what the kit says of a component."""
    with pytest.raises(AssertionError) as caught:
        getattr(testing, f"check_{family}")(component)
    return str(caught.value).split("\n")


@pytest.fixture(autouse=True)
def _tasks_are_short(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let tasks of the kit be short, except where one is to outlive its map."""
    if "when it is closed" not in request.node.name:
        monkeypatch.setattr(executors, "_DURATION", 0.01)


@each_broken
def test_kit_refuses(name: str, rule: str, broken: Broken) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    component = make(FAMILIES[name], broken)
    first, demand, finding, *_ = kit_says(component.family, component)
    assert first == f"{type(component).__name__} breaks the rule {rule}", finding
    assert len(demand) > len("required: ")
    assert len(finding) > len("violation: ")


@each_broken
def test_run(
    name: str, rule: str, broken: Broken, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run refuses it by name before a result is wrong, or says so in a status, or takes it."""
    monkeypatch.chdir(tmp_path)
    family, said = FAMILIES[name], broken.run
    for use in broken.where or family.usual:
        component = make(family, broken)
        if isinstance(said, Refused):
            with pytest.raises(said.error) as caught:
                family.uses[use](component, tmp_path / use)
            text = " ".join([str(caught.value), *getattr(caught.value, "__notes__", ())])
            by_rule = [f"the rule {rule}: "] if said is RULE else []
            for word in (f"{component.family} 'broken'", *said.words, *by_rule):
                assert word in text
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pl.ConvergenceWarning)
            code = family.uses[use](component, tmp_path / use)
        assert code == ("CONVERGED" if isinstance(said, Taken) else said.code)


@each_family
def test_each_rule_refuses_one(name: str) -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    rules = RULES if name == "component" else rules_of(f"pellicle.testing.{name}s")
    names = {rule.__name__ for rule in (*rules, *CHEAP.get(name, ()))}
    assert FAMILIES[name].broken.keys() - {"is_registered"} == names


@each_family
@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
def test_what_they_are_made_of_is_whole(name: str, tmp_path: Path) -> None:
    """Without its fault each breaks nothing but that no plugin registers it."""
    family = FAMILIES[name]
    for good in {family.good, *(Relaxing for _ in range(name == "kernel"))}:
        component = good(**family.settings)
        message = "\n".join(kit_says(component.family, component))
        assert "breaks the rule is_registered\n" in message
        assert f'"{component.family}.broken" = "' in message
        assert "pip install -e ." in message
    for use in family.usual:
        assert family.uses[use](family.good(**family.settings), tmp_path / use) == "CONVERGED"


STEP: Any = PARTS | {"loading": {"depth": "2 um"}}


class Changing(Output):
    """Changes all that can be changed of the data that it gets."""

    def step(self, record: Any, stem: Any) -> None:
        for name in ("x", "status", "pressure"):
            # Whether coordinates can be written to, and are copies then, is up to pandas.
            with suppress(ValueError):
                record[name].values[...] = "perfect" if name == "status" else 0
        record["force"] = record["force"] * 2
        record["force"].attrs["units"] = "kN"
        record.attrs["configuration"] = "{}"
        del record["depth"]

    def write(self, runs: Any, stem: Any) -> Any:
        self.step(runs.open(), stem)
        return ()


class Looking(Output):
    """Keeps what it gets."""

    type: Literal["looking"] = "looking"  # type: ignore[assignment]
    seen: ClassVar[list[Any]] = []

    def write(self, runs: Any, stem: Any) -> Any:
        self.seen.append(runs.open().copy())
        return ()


def test_an_output_cannot_change_the_result(tmp_path: Path) -> None:
    """What it writes into its data reaches neither the file, nor the result, nor other outputs."""
    plain, changed = (
        pl.run(STEP | {"outputs": outputs}, directory=tmp_path / name, progress=False).dataset
        for name, outputs in (("plain", []), ("changed", [Changing(), Looking()]))
    )
    (file,) = (tmp_path / "changed").glob("*.h5")
    for data in (changed, pl.load(file).dataset, *Looking.seen):
        for name in ("pressure", "status", "force", "x", "depth"):
            np.testing.assert_array_equal(data[name], plain[name])
        assert data["force"].attrs["units"] == "N"
        assert "half_space" in data.attrs["configuration"]
    # Only outputs are given read-only arrays: a user may write into a result.
    changed["pressure"].values[...] = 1


CONE = {"type": "cone", "half_angle": "20 degree"}
ROUGH = {"type": "self_affine", "rms_height": "1 um", "hurst": 0.5, "cutoff_wavelength": "50 um"}


@pytest.mark.parametrize("points", [12, 13, 2, 1, [12, 1]], ids=str)
def test_an_apex_between_the_cells_is_no_fault(points: Any) -> None:
    """However coarse the grid, a profile that is 0 between or beyond its cells is taken.

    A body of four cells, or roughness of few cells, may miss 0 by all its height.
    """
    few: Any = [{"type": "sphere", "radius": "15 um"}, ROUGH] if points == 12 else []
    for indenter in (
        {"type": "paraboloid", "radius": "0.1 mm"},
        CONE,
        {"type": "shifted", "x": "9 um", "part": CONE},
        {"type": "shifted", "x": "1 mm", "part": {"type": "paraboloid", "radius": "1 mm"}},
        {"type": "sphere", "radius": "0.1 mm"},
        {"type": "flat_punch", "radius": "0.1 mm"},
        *few,
    ):
        # No pressure at all, so that nothing is refused for another reason.
        grid = {"points": points, "size": "0.24 mm"}
        assert run(indenter=indenter, grid=grid, loading={"force": 0}) == "CONVERGED"


@pytest.mark.parametrize("thickness", ["1 nm", "1 um", "20 um"])
def test_a_thin_incompressible_layer_may_yield_more_to_shorter_waves(thickness: str) -> None:
    """On cells wider than the layer G(q) grows over all of the grid's waves, and is allowed to."""
    kernel = pl.kernel("bonded_layer", reduced_modulus=1e4, poissons_ratio=0.5, thickness=thickness)
    grid = pl.Grid(points=8, size="4 mm", boundary="periodic")
    values = kernel.compliance(np.linspace(1, 2, 5) * np.pi / 5e-4)
    assert (np.diff(values) > 0).all()
    assert pl.displacement(np.eye(8), kernel=kernel, grid=grid).max() > 0


class Softening(Kernel):
    """Half-space whose closed form is that of another."""

    def radial_primitive(self, r: Any) -> Any:
        return 1.01 * super().radial_primitive(r)


def test_a_substrate_of_others_is_asked() -> None:
    """A stranger's kernel is asked for its rules inside one of ours too, and ours is not blamed."""
    coated = {"type": "coated", "tension": 0.1, "substrate": Softening(reduced_modulus=1e4)}
    with pytest.raises(pl.PluginError, match="kernel 'broken' breaks the rule primitive_is_the"):
        pl.run(STEP | {"kernel": coated}, progress=False)


@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
def test_a_slope_need_not_be_given() -> None:
    """The one that is measured keeps the contract, and a run takes it."""
    slope: Any = pl.Interaction.slope
    law = Broken("measured slope", Taken(""), slope=lambda f, gap: slope(f.__self__, gap))
    with pytest.raises(AssertionError, match="breaks the rule is_registered\n"):
        testing.check_interaction(make(INTERACTIONS, law))
    assert INTERACTIONS.uses["run"](make(INTERACTIONS, law), Path()) == "CONVERGED"


def test_a_solver_that_uses_its_memory_again_changes_no_earlier_step() -> None:
    """Each step keeps its own pressure, though the solver returns one array for all."""
    memory = np.zeros(GRID["points"])

    class Thrifty(Solver):
        def solve(self, problem: Any, start: Any, monitor: Any) -> Any:
            solution = super().solve(problem, start, monitor)
            memory[...] = solution.pressure
            return replace(solution, state=pl.State.of_pressure(memory))

    loading = {"depth": ["2 um", "4 um"]}
    thrifty, plain = (
        pl.run(STEP | {"solver": solver, "loading": loading}, progress=False).dataset["pressure"]
        for solver in (Thrifty(tolerance=1e-6), Solver(tolerance=1e-6))
    )
    np.testing.assert_array_equal(thrifty, plain)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        *((name, "the name of another variable") for name in ("force", "status", "x")),
        *((name, "not a name") for name in ("a/b", "")),
    ],
)
def test_a_variable_has_a_name_of_its_own(name: str, reason: str) -> None:
    """Registration refuses a prescription that reports what a result cannot hold."""
    members = {"__doc__": "V.", "__module__": __name__, "variables": (Variable(name, "m", "it"),)}
    with pytest.raises(pl.PluginError, match=f"variables has '{name}', which is {reason}"):
        checked_type(type("Reporting", (Volume,), members))


class NoType(pl.AreaCorrection):
    """Correction that has no type."""

    area: ClassVar[Any] = Correction.area


@pytest.mark.parametrize(
    ("component", "words"),
    [
        (Correction, "BrokenYastrebov is a class; pass an instance: BrokenYastrebov(…)"),
        (Executor(), "breaks the rule is_an_instance"),
        (NoType(), 'NoType needs a field: type: Literal["…"] = "…"'),
    ],
)
def test_the_kit_says_what_is_no_component(component: Any, words: str) -> None:
    """A class, a component of another family and a class without a type are told what they lack."""
    with pytest.raises(AssertionError, match="breaks the rule") as caught:
        testing.check_correction(component)
    assert words in str(caught.value)


def test_what_a_component_raises_is_the_cause() -> None:
    """An error of the author's own code comes with its traceback."""
    raising = Broken("raises", Taken(""), attempt=lambda f, work, task, say: work(task, say))
    with pytest.raises(AssertionError, match="ValueError") as caught:
        testing.check_executor(make(EXECUTORS, raising))
    assert isinstance(caught.value.__cause__, ValueError)


def _register(monkeypatch: pytest.MonkeyPatch, module: Any, component: Any) -> None:
    ours = registry()
    entry = replace(ours.components["indenter"]["paraboloid"], component=component, type="broken")
    indenters = {**ours.components["indenter"], "broken": entry}
    changed = replace(ours, components={**ours.components, "indenter": indenters})
    monkeypatch.setattr(module, "registry", lambda: changed)


def test_the_registry_makes_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """A component that is installed, and another when it has been a table, is caught."""
    _register(monkeypatch, component_rules, TwoFaced)
    with pytest.raises(AssertionError, match="breaks the rule goes_through_the_registry\n"):
        testing.check_indenter(TwoFaced(radius=1e-3))
