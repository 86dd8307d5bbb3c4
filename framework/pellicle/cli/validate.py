"""``pellicle validate``."""

from __future__ import annotations

from typing import Annotated

import typer

from pellicle.errors import PluginError

from .printing import echo, print_json, print_table


def validate(json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False) -> None:
    """Solve the shipped problems of known solution; exit code 0 only if all agree."""
    from pellicle.components.installed import registry
    from pellicle.runs import validation
    from pellicle.show import sentences, tables

    done = list(validation.validate())
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
        print_table(tables.verdicts(done))
        echo(sentences.outcome_of_cases(done, registry().components["kernel"]))
    raise typer.Exit(0 if passed else 1)
