"""What holds of everything that is registered, by the kit, and what our own executors keep more."""

import math
import sys
import threading
import time
from pathlib import Path
from typing import Annotated, Any

import cloudpickle
import jsonschema
import numpy as np
import pytest
from pydantic import create_model

import pellicle as pl
from pellicle import ConfigError, Executor, Run, testing
from pellicle.components import Component, FromRegistry, Say
from pellicle.components.installed import FAMILIES, registry
from pellicle.config.json_schema import model_schema
from pellicle.plugins.registry import family_of
from pellicle.runs.runner import solve
from pellicle.testing.component import kit_of, require_close
from tests.plugins.executors.jobs import Job, silence


@pytest.fixture(scope="module")
def schemas() -> dict[str, jsonschema.Draft202012Validator]:
    """Return a validator of each family's tables, as a run or a study has them."""

    def validator(family: str, base: Any) -> jsonschema.Draft202012Validator:
        table = create_model(family, it=(Annotated[base, FromRegistry()], ...))
        return jsonschema.Draft202012Validator(model_schema(table))

    return {
        family: validator(family, base)
        for family, base in registry().families.items()
        if registry().components[family]
    }


def test_nothing_installed_is_broken() -> None:
    """Every entry point loads and no two plugins claim one name."""
    assert registry().broken == ()
    assert registry().clashes == {}


def test_schema_takes_what_the_component_takes(
    component: Component,
    examples: dict[str, dict[str, Any]],
    schemas: dict[str, jsonschema.Draft202012Validator],
) -> None:
    """The schema accepts the component as it is written by hand and as it is dumped."""
    table = component.model_dump(mode="json", exclude_none=True)
    schemas[component.family].validate({"it": table})
    by_hand = examples[component.family][table["type"]]
    schemas[component.family].validate({"it": {"type": table["type"], **by_hand}})


def test_schema_refuses_what_the_component_refuses(
    component: Component, schemas: dict[str, jsonschema.Draft202012Validator]
) -> None:
    """An editor marks an unknown field and an unknown type."""
    table = component.model_dump(mode="json", exclude_none=True)
    assert not schemas[component.family].is_valid({"it": table | {"nonsense": 1}})
    assert not schemas[component.family].is_valid({"it": table | {"type": "nonsense"}})


def test_keeps_its_contract(component: Component) -> None:
    """One call checks all that is asked of a component."""
    check = kit_of(family_of(type(component)))
    assert check is not None
    check(component)


def test_each_family_has_a_check() -> None:
    """The kit has a function for each family, named after it, and no others."""
    named = {name for name in vars(testing) if name.startswith("check_")}
    assert named == {f"check_{family}" for family in FAMILIES}
    assert all(map(kit_of, registry().families.values()))


def test_a_skin_of_little_tension_keeps_the_contract() -> None:
    """The closed form of an elastocapillary length of 2 pm is right to eight digits only."""
    testing.check_kernel(pl.kernel("tensed_membrane", reduced_modulus="1 GPa", tension="1 mN/m"))


def test_infinite_values_agree_with_their_equals_only() -> None:
    """Infinity is close to itself, and to no number, however large the allowed share."""
    require_close([math.inf, -math.inf, 1.0], [math.inf, -math.inf, 1.0], "the gap", relative=0.1)
    for actual, expected in ((1.0, math.inf), (-math.inf, math.inf), (math.inf, 1.0)):
        with pytest.raises(AssertionError, match=f"the gap is {actual:g}.*expected {expected:g}"):
            require_close([actual], [expected], "the gap", relative=0.1)
    with pytest.raises(AssertionError, match="the gap is nan"):
        require_close([math.nan], [math.nan], "the gap")


def test_result_has_the_periodic_area() -> None:
    """On a periodic grid a contact has the same corrected area wherever the domain is cut."""

    def areas(shift: float) -> tuple[float, float]:
        x = np.arange(24)[:, None] + shift
        heights = np.cos(2 * np.pi * x / 24) + np.cos(2 * np.pi * np.arange(24) / 24)
        run = Run(
            grid={"points": 24, "size": 1e-3, "boundary": "periodic"},
            kernel={"type": "half_space", "reduced_modulus": 1e4},
            indenter={"type": "heights", "values": heights, "unit": "1 um"},
            loading={"mean_pressure": 10.0},
            corrections=[{"type": "yastrebov"}],
        )
        data = solve(run).dataset
        return data["contact_area"].item(), data["contact_area_yastrebov"].item()

    (cells, inside), (cells_across, across) = areas(12), areas(0)
    assert cells == cells_across
    assert inside < cells
    assert across == pytest.approx(inside, rel=1e-12)


# Workers cannot import a module of a folder that is no package.
cloudpickle.register_pickle_by_value(sys.modules[__name__])

WAITING = 60
"""Tasks that take longer, all of them, than it takes to close an executor."""
PATIENCE = 60.0


class FussyError(Exception):
    """Pickles, and cannot be read back."""

    def __init__(self, first: str, second: str) -> None:
        super().__init__(first + second)


def misbehave(job: Job, say: Say) -> Any:
    """Do at each of the first four jobs what a bad plugin might; wait for these at the others."""
    (job.folder / str(job.number)).touch()
    match job.number:
        case 0:
            raise ConfigError("it is odd", "job.number")
        case 1:
            raise SystemExit(3)
        case 2:
            return threading.Lock()
        case 3:
            raise FussyError("two ", "parts")
    end = time.monotonic() + PATIENCE
    while not all((job.folder / str(bad)).exists() for bad in range(4)):
        assert time.monotonic() < end
        time.sleep(0.01)
    time.sleep(0.02)
    return job.number


def test_whatever_tasks_do(executor: Executor, tmp_path: Path) -> None:
    """What is raised comes whole, and what cannot travel is said; closed early, the rest waits."""
    jobs = [Job(i, tmp_path) for i in range(4 + WAITING)]
    outcomes: Any = executor.map(misbehave, jobs, silence)
    values: dict[int, Any] = {}
    for job, outcome in outcomes:
        values[job.number] = outcome
        if values.keys() >= {0, 1, 2, 3}:
            break
    outcomes.close()
    begun = {int(path.name) for path in tmp_path.iterdir()}
    assert values.keys() >= {0, 1, 2, 3}
    assert values.keys() <= begun
    assert len(begun) < len(jobs)
    assert all(values[number] == number for number in values.keys() - {0, 1, 2, 3})
    assert isinstance(values[0], ConfigError)
    assert str(values[0]) == "job.number: it is odd"
    assert isinstance(values[1], Exception)
    assert "job 1" in str(values[1])
    if isinstance(values[2], Exception):
        assert "job 2" in str(values[2])
        assert "pickle" in str(values[2])
    else:
        assert isinstance(values[2], type(threading.Lock()))
    assert isinstance(values[3], Exception)
    assert "two parts" in str(values[3])


def test_compliance_of_whole_waves(kernel: Any) -> None:
    """Waves that are whole numbers have the compliance of the same as floats."""
    if kernel.is_isotropic:
        waves = np.arange(1, 6)
        np.testing.assert_allclose(kernel.compliance(waves), kernel.compliance(1.0 * waves))


def test_traction_at_whole_places(load: Any) -> None:
    """Places that are whole numbers have the traction of the same as floats."""
    if load.type_name != "map":
        x, y = np.meshgrid(np.arange(-2, 3), np.arange(-2, 3), indexing="ij")
        np.testing.assert_allclose(load.traction(x, y), load.traction(1.0 * x, 1.0 * y))
