"""``pellicle validate``."""

from __future__ import annotations

import typer

from pellicle.errors import PluginError

from .printing import print_table


def validate() -> None:
    """Solve the shipped problems of known solution; exit code 0 only if all agree."""
    from pellicle.runs.validation import validate as verdicts

    rows, passed = [], True
    for verdict in verdicts():
        case = verdict.case
        passed &= verdict.passed
        rows.append(
            {
                "case": case.name,
                "expected": f"{case.expected:.8g} {case.unit}",
                "computed": f"{verdict.computed:.8g} {case.unit}",
                "error": f"{verdict.error:.1e}",
                "allowed": f"{case.tolerance:.0e}",
                "verdict": "ok" if verdict.passed else "FAILED",
                "source": case.source,
            }
        )
    print_table(["case", "expected", "computed", "error", "allowed", "verdict", "source"], rows)
    if not rows:
        raise PluginError("no cases are registered; see what is broken with `pellicle plugins`")
    raise typer.Exit(0 if passed else 1)
