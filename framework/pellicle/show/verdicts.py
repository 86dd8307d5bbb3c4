"""The outcome of problems of known solution."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from pellicle.components.charts import Table
from pellicle.units import axis_unit

if TYPE_CHECKING:
    from pellicle.runs.validation import CheckedCase

_DIGITS = 8
_POWERS = str.maketrans("²³", "23")


def verdicts(cases: Iterable[CheckedCase]) -> Table:
    """Return expected and computed values, with digits to compare, in the unit of the expected."""
    rows = []
    for checked in cases:
        case = checked.case
        scale = axis_unit(case.expected, case.unit.translate(_POWERS))
        values = (scale.text(value, _DIGITS) for value in (case.expected, checked.computed))
        verdict = "ok" if checked.passed else f"FAILED {checked.problem}".strip()
        errors = f"{checked.error:.1e}", f"{case.tolerance:.0e}"
        rows.append((case.name, *values, *errors, verdict, case.source))
    heads = "case", "expected", "computed", "error", "allowed", "verdict", "source"
    return Table.of_rows(heads, rows)


def outcome(cases: Sequence[CheckedCase], kernels: Iterable[str]) -> str:
    """Return how many cases failed, and the kernels among ``kernels`` that none is about."""
    failed, count = sum(not checked.passed for checked in cases), len(cases)
    passed = f"{failed} of {count} cases failed" if failed else f"all {count} cases passed"
    solved = {checked.case.configuration["kernel"]["type"] for checked in cases}
    others = ", ".join(sorted({*kernels} - solved))
    return f"{passed}; no case is about the kernels {others}" if others else passed
