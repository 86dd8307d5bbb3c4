"""What no table shows: several components together, and what looks broken and is not."""

from __future__ import annotations

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
from pellicle.plugins.registry import checked_type
from pellicle.testing import component as component_rules
from tests.framework.broken.catalogue import GRID, PARTS, Broken, Taken, make, run
from tests.framework.broken.corrections import Correction
from tests.framework.broken.executors import EXECUTORS, Executor
from tests.framework.broken.general import TwoFaced
from tests.framework.broken.interactions import INTERACTIONS
from tests.framework.broken.kernels import Kernel
from tests.framework.broken.outputs import Output
from tests.framework.broken.prescriptions import Volume
from tests.framework.broken.solvers import Solver

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
        (Correction, "Correction is a class; pass an instance: Correction(…)"),
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
