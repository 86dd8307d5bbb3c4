"""``pellicle validate``."""

from __future__ import annotations

from typing import Annotated

import typer

from pellicle.errors import PluginError

from .printing import echo, print_columns, print_json

_DIGITS = 8


def validate(
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Solve the shipped problems of known solution; exit code 0 only if all agree."""
    from pellicle.plugins import registry
    from pellicle.runs.validation import validate as verdicts
    from pellicle.units import axis_unit

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
        units = [v.case.unit.translate({ord("²"): "2", ord("³"): "3"}) for v in done]
        # Digits to compare, in the unit that suits the expected value.
        scales = [axis_unit(v.case.expected, u) for v, u in zip(done, units, strict=True)]
        shown = [*zip(done, scales, strict=True)]
        columns = {
            "case": [v.case.name for v in done],
            "expected": [scale.text(v.case.expected, _DIGITS) for v, scale in shown],
            "computed": [scale.text(v.computed, _DIGITS) for v, scale in shown],
            "error": [f"{v.error:.1e}" for v in done],
            "allowed": [f"{v.case.tolerance:.0e}" for v in done],
            "verdict": ["ok" if v.passed else f"FAILED {v.problem}".strip() for v in done],
            "source": [v.case.source for v in done],
        }
        print_columns([*columns.items()])
        failed, count = sum(not v.passed for v in done), len(done)
        outcome = f"{failed} of {count} cases failed" if failed else f"all {count} cases passed"
        solved = {v.case.configuration["kernel"]["type"] for v in done}
        others = ", ".join(sorted(registry().components["kernel"].keys() - solved))
        echo(f"{outcome}; no case is about the kernels {others}" if others else outcome)
    raise typer.Exit(0 if passed else 1)
