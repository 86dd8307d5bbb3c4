"""Contract rules of prescriptions: a step has the prescribed value."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from pellicle.components import Force, Prescription, Search, Setting, Solver
from pellicle.components.calls import check_values, report_of, target_of
from pellicle.config.run import Run
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.load_step import LoadStep
from pellicle.contact.solution import Stop
from pellicle.errors import ConfigError
from pellicle.results.record import step_dataset
from pellicle.runs.compose import compose
from pellicle.runs.solve import solve_at

from .component import check, require, require_close, rules_of
from .small_runs import HALF_SPACE, ROUGH, ignore

# A contact area of whole cells misses its value by more than other quantities do.
_NEAR = 0.05


def check_prescription(prescription: Prescription, values: Sequence[float] = ()) -> None:
    """Check that a prescription keeps its contract: the rules below, and those of all components.

    The steps are of a rough surface of 1 mm × 1 mm and 10 µm root mean square height on a periodic
    half-space of 10 kPa, under 0.1 and 0.2 mN. ``values`` are the prescribed quantity [its unit]
    under these two forces. They can be left out if a result has a variable named like the
    prescription's type, for example from ``report``.
    """
    check(prescription, Prescription, rules_of(__name__), tuple(values))


@cache
def _reference_steps() -> tuple[Setting, tuple[Equilibrium, ...], Solver]:
    """Return the setting, the two steps that are known, and their solver."""
    grid: Any = {"points": 32, "size": "1 mm", "boundary": "periodic"}
    loading: Any = {"force": ["0.1 mN", "0.2 mN"]}
    run = Run(grid=grid, kernel=HALF_SPACE, indenter=ROUGH, loading=loading)
    setting = compose(run)
    forces = run.indentation.loading.values
    steps = [solve_at(setting, Force(force), run.solver, ignore) for force in forces]
    return setting, tuple(step.equilibrium for step in steps), run.solver


def _value(prescription: Prescription, step: Equilibrium) -> float | None:
    """Return the prescribed quantity of a step, if a result has it."""
    setting, _, _ = _reference_steps()
    report = report_of(prescription, setting, step)
    name = prescription.type_name
    if name in report:
        return report[name]
    data = step_dataset(setting.grid, 1, LoadStep(step, 0, Stop.DONE))
    return float(data[name].item()) if name in data and data[name].size == 1 else None


def _values(prescription: Prescription, candidates: Sequence[float]) -> list[float]:
    _, steps, _ = _reference_steps()
    values: Sequence[float | None] = candidates or [_value(prescription, s) for s in steps]
    numbers = [value for value in values if value is not None]
    require(
        len(numbers) == len(steps),
        f"no variable {prescription.type_name!r} in a result; report it, or call "
        "check_prescription with two values",
    )
    return numbers


def report_is_as_declared(prescription: Prescription, values: Sequence[float]) -> None:
    """report() returns numbers under the names of `variables`, the same in a second call."""
    setting, steps, _ = _reference_steps()
    for step in steps:
        report = report_of(prescription, setting, step)
        require(report == report_of(prescription, setting, step), "the second report differs")


def target_is_pure(prescription: Prescription, values: Sequence[float]) -> None:
    """target() returns a Depth, Force or Search of finite numbers, the same in a second call."""
    setting, _, _ = _reference_steps()
    for value in _values(prescription, values):
        check_values(prescription, setting, [value])
        members = (vars(target_of(prescription, setting, value)).items() for _ in range(2))
        first, second = ({k: v for k, v in target if k != "measure"} for target in members)
        require(first == second, f"{second} after {first}")


def values_are_refused_in_words(prescription: Prescription, values: Sequence[float]) -> None:
    """At 0 and far beyond what can be reached, check() raises a ConfigError or target() works."""
    setting, _, _ = _reference_steps()
    for value in (0.0, 1e12 * max(map(abs, _values(prescription, values)))):
        try:
            check_values(prescription, setting, [value])
        except ConfigError:
            continue
        target_of(prescription, setting, value)


def search_goes_one_way(prescription: Prescription, values: Sequence[float]) -> None:
    """If the force doubles, the quantity of a search does not fall, or not grow if it falls."""
    setting, steps, _ = _reference_steps()
    target = target_of(prescription, setting, _values(prescription, values)[0])
    if isinstance(target, Search):
        low, high = (target.measure(step) for step in steps)
        require(
            low <= high if target.increasing else low >= high,
            f"{low:g} under 0.1 mN and {high:g} under 0.2 mN; give increasing={low <= high}",
        )


def step_has_what_is_prescribed(prescription: Prescription, values: Sequence[float]) -> None:
    """Prescribing the value of a known step reproduces its force and its value."""
    setting, steps, solver = _reference_steps()
    for value, reference in zip(_values(prescription, values), steps, strict=True):
        target = target_of(prescription, setting, value)
        step = solve_at(setting, target, solver, ignore).equilibrium
        what = f"the force [N] at {value:g} {prescription.unit}"
        require_close(step.force, reference.force, what, relative=_NEAR)
        again = _value(prescription, step)
        if again is not None:
            require_close(again, value, f"{prescription.type_name} prescribed", relative=_NEAR)
