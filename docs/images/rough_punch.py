"""The published rough case: contact fraction at δ = 10σ for several seeds, two tensions.

Yuan & Wang 2020, Figure 8: L = 1 mm, N = 1024, σ = 0.01 mm, H = 0.7, q₀ = 2π/L, q_s = 2π/(16L/N),
E* = 10 kPa, free boundary; 43.5 % at τ₀ = 0 and 7.95 % at 100 mN/m. docs/paper.md has
the mean and the spread of 64 realisations.

    python docs/images/rough_punch.py            (about two minutes on one core)
    python docs/images/rough_punch.py --points 256 --seeds 3     (longer waves: another surface)
"""

from __future__ import annotations

import argparse

import numpy as np

import pellicle as pl

TENSIONS = ("0 mN/m", "100 mN/m")
PUBLISHED = (0.435, 0.0795)


def fractions(points: int, seed: int, tension: str) -> tuple[float, float]:
    """Return the contact fraction as counted and as corrected."""
    run = pl.Run(
        grid={"points": points, "size": "1 mm"},
        kernel={"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": tension},
        indenter={
            "type": "self_affine",
            "rms_height": "0.01 mm",
            "hurst": 0.7,
            "cutoff_wavelength": 16e-3 / points,
            "seed": seed,
        },
        loading={"depth": "0.1 mm"},
        solver={"type": "active_set", "tolerance": 1e-6},
        corrections=[{"type": "yastrebov"}],
    )
    step = pl.run(run, progress=False).dataset.isel(step=0)
    return float(step["contact_fraction"]), float(step["contact_area_yastrebov"]) / run.grid.area


def main() -> None:
    """Solve every seed and print a Markdown table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--points", type=int, default=1024)
    parser.add_argument("--seeds", type=int, default=8)
    options = parser.parse_args()
    print("| seed | counted, 0 | counted, 100 mN/m | corrected, 0 | corrected, 100 mN/m | ratio |")
    print("| --- | --- | --- | --- | --- | --- |")
    rows = []
    for seed in range(options.seeds):
        (bare, fair), (tensed, tensed_fair) = (
            fractions(options.points, seed, tension) for tension in TENSIONS
        )
        rows.append([bare, tensed, fair, tensed_fair, tensed_fair / fair])
        _print_row(str(seed), rows[-1])
    _print_row("mean", np.mean(rows, axis=0))
    _print_row("lowest", np.min(rows, axis=0))
    _print_row("highest", np.max(rows, axis=0))
    _print_row("published", [np.nan, np.nan, *PUBLISHED, PUBLISHED[1] / PUBLISHED[0]])


def _print_row(name: str, values: object) -> None:
    *shares, ratio = np.asarray(values)
    cells = ["" if np.isnan(share) else f"{share:.2%}" for share in shares]
    print(f"| {name} | {' | '.join(cells)} | {ratio:.4f} |", flush=True)


if __name__ == "__main__":
    main()
