"""The table of many curves for a paper, in kPa and mN/m: CSV, Markdown and LaTeX."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from pellicle.files import atomic_write, for_document
from pellicle.units import Scale
from pellicle_fit.population.row import Row
from pellicle_fit.words.names import FEW, value_and_ends

_BLOCK = 1000
_KILOPASCAL, _MILLINEWTON = Scale(1e-3, "kPa"), Scale(1e3, "mN/m")


def save_tables(rows: Sequence[Row], stem: Path) -> list[Path]:
    """Write ``stem.csv``, ``stem.md`` and ``stem.tex``, a line for each curve, and return them.

    The modulus is Young's where it is known; ``n`` is the number of points.  A value whose interval
    is open or wide is left out.
    """
    has_youngs = any("youngs_modulus" in row.fit.estimates() for row in rows)
    modulus = ("E", "youngs_modulus") if has_youngs else ("E*", "reduced_modulus")
    lines = []
    for row in rows:
        verdict = row.fit.headline if row.accepted else f"not accepted: {row.reason}"
        line = {"curve": " ".join(for_document(row.name).splitlines()), "verdict": verdict}
        for unit, head, name in ((_KILOPASCAL, *modulus), (_MILLINEWTON, "tension", "tension")):
            e = row.fit.estimates().get(name)
            is_known = e is not None and (e.value or not e.held)
            value, ends = value_and_ends(e, unit, FEW) if e and is_known else ("", "")
            line[f"{head} [{unit.unit}]"] = value
            line[f"95 % interval [{unit.unit}]"] = ends
        lines.append(line | {"n": str(row.fit.curve.get("points", ""))})
    frame = pd.DataFrame(lines)
    cells = [[*frame], ["---"] * frame.shape[1], *frame.to_numpy().tolist()]
    marked = (" | ".join(cell.replace("|", "\\|") for cell in line) for line in cells)
    latex = _latex(frame)
    texts = {
        ".csv": frame.to_csv(index=False, lineterminator="\n"),
        ".md": "".join(f"| {line} |\n" for line in marked),
        # In the usual font encoding these are other characters.
        ".tex": re.sub("[<>|]", r"$\g<0>$", latex),
    }
    for ending, text in texts.items():
        with atomic_write(stem.with_suffix(ending)) as part:
            part.write_bytes(text.encode())
    return [stem.with_suffix(ending) for ending in texts]


def _latex(frame: pd.DataFrame) -> str:
    """Return a table as LaTeX, some lines of it at a time, as pandas takes 7 kB for each."""
    head, middle, end, bodies = "", "\\midrule\n", "\\bottomrule\n", []
    for first in range(0, max(len(frame), 1), _BLOCK):
        part = frame[first : first + _BLOCK]
        text = part.to_latex(index=False, escape=True, column_format="llrlrlr")
        head, _, body = text.partition(middle)
        body, _, tail = body.partition(end)
        bodies.append(body)
    return "".join([head, middle, *bodies, end, tail])
