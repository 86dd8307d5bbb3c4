"""``pellicle validate``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from pellicle.errors import PluginError

from .printing import print_columns, print_json

if TYPE_CHECKING:
    from pellicle.components import Case

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
        print_columns(
            [
                ("case", [verdict.case.name for verdict in done]),
                ("expected", [_value(v.case.expected, v.case) for v in done]),
                ("computed", [_value(v.computed, v.case) for v in done]),
                ("error", [f"{verdict.error:.1e}" for verdict in done]),
                ("allowed", [f"{verdict.case.tolerance:.0e}" for verdict in done]),
                ("verdict", ["ok" if verdict.passed else "FAILED" for verdict in done]),
                ("source", [verdict.case.source for verdict in done]),
            ]
        )
    raise typer.Exit(0 if passed else 1)


def _value(value: float, case: Case) -> str:
    """Return a value in the unit that suits the expected one, with digits to compare."""
    from pellicle.units import axis_unit

    return axis_unit(case.expected, case.unit).text(value, _DIGITS)
