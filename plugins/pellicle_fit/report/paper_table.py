"""The table of many curves for a paper, in kPa and mN/m: CSV, Markdown and LaTeX."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pellicle.files import atomic_write, for_document
from pellicle.units import Scale
from pellicle_fit.intervals import CONFIDENCE, Estimate
from pellicle_fit.population.row import Row
from pellicle_fit.words.names import FEW, quoted

_UNITS = {
    "reduced_modulus": ("E*", Scale(1e-3, "kPa")),
    "youngs_modulus": ("E", Scale(1e-3, "kPa")),
    "tension": ("tension", Scale(1e3, "mN/m")),
}


def save_tables(rows: Sequence[Row], stem: Path) -> list[Path]:
    """Write ``stem.csv``, ``stem.md`` and ``stem.tex``, a row for each curve, and return them.

    The columns are curve, verdict, modulus (Young's where it is known) and tension with their
    intervals, and n, the number of points.  A value whose interval is open or wide is left out.
    """
    import pandas as pd

    modulus = (
        "youngs_modulus"
        if any("youngs_modulus" in r.estimates for r in rows)
        else "reduced_modulus"
    )
    columns: dict[str, list[str]] = {"curve": [for_document(row.name) for row in rows]}
    columns["verdict"] = [
        row.verdict if row.accepted else f"not accepted: {row.reason}" for row in rows
    ]
    for name in (modulus, "tension"):
        symbol, unit = _UNITS[name]
        cells = [_cells(row.estimates.get(name), unit) for row in rows]
        columns[f"{symbol} [{unit.unit}]"] = [value for value, _ in cells]
        columns[f"{100 * CONFIDENCE:.0f} % interval [{unit.unit}]"] = [ends for _, ends in cells]
    columns["n"] = [str(row.curve.get("points", "")) for row in rows]
    frame = pd.DataFrame(columns)
    table = [[*frame], ["---"] * len(columns), *frame.to_numpy().tolist()]
    lines = (" | ".join(cell.replace("|", "\\|") for cell in line) for line in table)
    latex = frame.to_latex(index=False, escape=True, column_format="llrlrlr")
    texts = {
        "csv": frame.to_csv(index=False, lineterminator="\n"),
        "md": "".join(f"| {line} |\n" for line in lines),
        # In the usual font encoding they are other characters.
        "tex": latex.replace("<", "$<$").replace(">", "$>$"),
    }
    for kind, text in texts.items():
        with atomic_write(stem.with_suffix(f".{kind}")) as part:
            part.write_bytes(text.encode())
    return [stem.with_suffix(f".{kind}") for kind in texts]


def _cells(estimate: Estimate | None, unit: Scale) -> tuple[str, str]:
    """Return a value and its interval; a value that cannot be quoted is empty."""
    if estimate is None or (estimate.held and not estimate.value):
        return "", ""
    value, _, ends = quoted(estimate, unit, FEW).rpartition(" (")
    return (value, ends.removesuffix(")")) if value else ("", ends)
