"""``pellicle validate``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from pellicle.errors import PluginError

from .printing import echo, print_columns, print_json

if TYPE_CHECKING:
    from pellicle.components import Case
    from pellicle.runs.validation import CheckedCase

_DIGITS = 8


def validate(
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Solve the shipped problems of known solution; exit code 0 only if all agree."""
    from pellicle.runs.validation import validate as verdicts

    done = list(verdicts())
    if not done:
        raise PluginError("no cases are registered; see what is broken with `pellicle plugins`")
    passed = all(verdict.passed for verdict in done)
    if json:
        cases = [
            {
                "case": verdict.case.name,
                "unit": verdict.case.unit,
                "expected": verdict.case.expected,
                "computed": verdict.computed,
                "error": verdict.error,
                "allowed": verdict.case.tolerance,
                "passed": verdict.passed,
                "source": verdict.case.source,
            }
            for verdict in done
        ]
        print_json({"passed": passed, "cases": cases})
    else:
        names = "case", [verdict.case.name for verdict in done]
        sources = "source", [verdict.case.source for verdict in done]
        numbers = [
            ("expected", [_value(v.case.expected, v.case) for v in done]),
            ("computed", [_value(v.computed, v.case) for v in done]),
            ("error", [f"{verdict.error:.1e}" for verdict in done]),
            ("allowed", [f"{verdict.case.tolerance:.0e}" for verdict in done]),
            ("verdict", ["ok" if v.passed else f"FAILED {v.problem}".strip() for v in done]),
        ]
        print_columns([names, *numbers, sources])
        echo(_summary(done))
    raise typer.Exit(0 if passed else 1)


def _summary(done: list[CheckedCase]) -> str:
    """Return how many cases passed, and the kernels of which no case exists."""
    from pellicle.plugins import registry

    failed = sum(not verdict.passed for verdict in done)
    outcome = f"{failed} of {len(done)} cases failed" if failed else f"all {len(done)} cases passed"
    solved = {verdict.case.configuration["kernel"]["type"] for verdict in done}
    others = sorted(registry().components["kernel"].keys() - solved)
    left_out = f"; no case is about the kernels {', '.join(others)}" if others else ""
    return f"{outcome}{left_out}"


def _value(value: float, case: Case) -> str:
    """Return a value in the unit that suits the expected one, with digits to compare."""
    from pellicle.units import axis_unit

    unit = case.unit.translate({ord("²"): "2", ord("³"): "3"})
    return axis_unit(case.expected, unit).text(value, _DIGITS)
