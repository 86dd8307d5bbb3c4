"""Random small problems of adhesion against a descent with dense matrices from the same start.

Prints how many steps ended how: by depth or force and boundary, those that converged, that are
not the stationary points they claim to be (w ≥ 0, gap ≥ 0, p = w + σ), that gave up where the
descent ends in contact, that have the energy of the descent to 1e-6, and that landed on another
branch, of lower or of higher energy.

    python tests/benchmarks/adhesion_random.py 300
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.random_adhesion import SAME, verdicts


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("number", type=int, nargs="?", default=300)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--list", action="store_true", help="name each step that differs")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    counts: dict[str, Counter[str]] = {}
    for seed in range(options.first, options.first + options.number):
        try:
            rows = verdicts(seed)
        except Exception as error:
            print(f"seed {seed}: {type(error).__name__}: {error}", file=sys.stderr, flush=True)
            counts.setdefault("failed", Counter())["steps"] += 1
            continue
        for row in rows:
            count = counts.setdefault(row.control, Counter())
            count["steps"] += 1
            count["converged"] += row.converged
            count["not honest"] += not row.honest
            if not row.settled:
                count["descent not settled"] += 1
            elif row.carried and not row.converged:
                count["given up"] += 1
            elif row.converged:
                kind = "lower" if row.difference < -SAME else "higher"
                count["same" if abs(row.difference) <= SAME else kind] += 1
            if options.list and not (row.honest and row.converged and abs(row.difference) <= SAME):
                print(
                    row.description, row.status, f"stationary {row.stationary}",
                    f"settled {row.settled}", f"difference {row.difference:.2e}",
                    file=sys.stderr, flush=True,
                )  # fmt: skip
    columns = (
        "steps", "converged", "not honest", "given up", "same", "lower", "higher",
        "descent not settled",
    )  # fmt: skip
    print("| control | " + " | ".join(columns) + " |")
    print("|" + " --- |" * (1 + len(columns)))
    for name, count in sorted(counts.items()):
        print(f"| {name} | " + " | ".join(str(count[column]) for column in columns) + " |")


if __name__ == "__main__":
    main()
