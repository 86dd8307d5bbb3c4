"""What kit and run say of each broken component, and that each rule of the kit refuses one."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

import pellicle as pl
from pellicle import testing
from pellicle.components.rules import CHEAP
from pellicle.testing import executors
from pellicle.testing.component import RULES, rules_of
from tests.framework.broken.catalogue import RULE, Broken, Refused, Taken, make
from tests.framework.broken.corrections import CORRECTIONS
from tests.framework.broken.executors import EXECUTORS
from tests.framework.broken.general import GENERAL
from tests.framework.broken.indenters import INDENTERS
from tests.framework.broken.interactions import INTERACTIONS
from tests.framework.broken.kernels import KERNELS, Relaxing
from tests.framework.broken.outputs import OUTPUTS
from tests.framework.broken.prescriptions import PRESCRIPTIONS
from tests.framework.broken.solvers import SOLVERS

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
