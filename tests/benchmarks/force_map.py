"""A force map of two materials, a thin layer in one corner and bad curves, fitted as a whole.

    python tests/benchmarks/force_map.py FOLDER [side [side of the map with every rival]]

The map of side² curves is written to a folder and fitted by ``pellicle fit``, a smaller one with
``--every-rival`` as well.  A CSV says what each took, the peak memory included, which verdicts are
equal, and the median modulus of each material over that of its curves.  What is done already is not
done again, so that an interrupted script goes on.
"""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pandas as pd

import pellicle as pl

RADIUS, DEPTH, ROWS, NOISE = 5e-6, 1.2e-6, 300, 0.005
BAD, SPREAD, PITCH = 0.05, 0.03, 1e-6
SOFT, STIFF, TENSION, THICKNESS = 2e3, 6e3, 3e-3, 2.5e-6
KINDS = "soft", "stiff under tension", "layer"
BAD_KINDS = "rubbish", "no contact", "cut"


def force_of(kind: str, modulus: float, depth: Any) -> Any:
    """Return the force [N] of a material at depths [m]."""
    bead: Any = pl.indenter("sphere", radius=RADIUS)
    if kind == "layer":
        return modulus * bead.layer_force_curve(depth, 0.0, THICKNESS, 0.5).force
    length = 2 * TENSION / modulus if kind == KINDS[1] else 0.0
    return modulus * bead.force_curve(depth, length).force


def measure(folder: Path, side: int) -> pd.DataFrame:
    """Write a map and the table that lists it; return kind, fault and modulus [Pa] of each."""
    folder.mkdir(parents=True, exist_ok=True)
    random, truth, lines = np.random.default_rng(side), [], ["file,x [um],y [um]"]
    for number in range(side**2):
        y, x = divmod(number, side)
        corner = x < side // 4 and y < side // 4
        kind = KINDS[2 if corner else int(x >= side // 2)]
        modulus = (STIFF if kind == KINDS[1] else SOFT) * np.exp(SPREAD * random.standard_normal())
        depth = np.linspace(-0.4, 1.0, ROWS) * DEPTH
        fault = str(random.choice(BAD_KINDS)) if random.random() < BAD else ""
        if fault == "cut":
            depth = depth[depth < 0.05 * DEPTH] if random.random() < 0.5 else depth[depth > 0]
        force = force_of(kind, modulus, depth)
        noise = NOISE * force_of(KINDS[0], SOFT, np.array([DEPTH]))[0]
        if fault == "no contact":
            force = 0 * force
        if fault == "rubbish":
            force = 20 * noise * np.cumsum(random.standard_normal(depth.size)) / 5
        force = force + noise * random.standard_normal(depth.size)
        table = np.column_stack([(depth + 1e-7 * (x + random.uniform(0, 5))) * 1e6, force * 1e9])
        head, name = "position [um],force [nN]", f"{number:05}.csv"
        np.savetxt(folder / name, table, "%.7g", ",", header=head, comments="")
        lines.append(f"{name},{1e6 * PITCH * x:g},{1e6 * PITCH * y:g}")
        truth.append((kind, fault, modulus))
    (folder / "map.csv").write_text("\n".join(lines), encoding="utf-8")
    return pd.DataFrame(truth, columns=["kind", "fault", "modulus"])


def fitted(folder: Path, name: str, *options: str) -> tuple[dict[str, float], pd.DataFrame]:
    """Fit the map of a folder in a process; return what it took, and the table of its curves."""
    out, began = folder / name, perf_counter()
    if not (out / "took.json").exists():
        command = [sys.executable, "-m", "pellicle", "fit", "map.csv", "--indenter", "sphere"]
        command += ["--radius", f"{RADIUS} m", "-o", name, "--report", "--quiet", *options]
        process = subprocess.Popen(command, cwd=folder, env=os.environ | {"OMP_NUM_THREADS": "1"})
        _, _, used = os.wait4(process.pid, 0)
        took = {
            "cpu": used.ru_utime + used.ru_stime,
            "wall": perf_counter() - began,
            "memory": used.ru_maxrss * 1024,
        }
        (out / "took.json").write_text(json.dumps(took), encoding="utf-8")
    whole = pd.read_csv(out / "fits.csv")
    return json.loads((out / "took.json").read_text(encoding="utf-8")), whole


def main() -> None:
    """Print a CSV with a row for each map and way to fit it."""
    folder = Path(sys.argv[1])
    side = int(sys.argv[2]) if len(sys.argv) > 2 else 64
    small = int(sys.argv[3]) if len(sys.argv) > 3 else min(side, 32)
    writer = csv.writer(sys.stdout, lineterminator="\n")
    names = "side", "fit", "curves", "CPU [s]", "CPU of a curve [s]", "wall [s]", "memory [MB]"
    same = "fitted", "compared in full", "same verdict", "same verdict of good curves"
    writer.writerow([*names, *same, *(f"median of {kind} / true" for kind in KINDS)])
    for length in dict.fromkeys((small, side)):
        here = folder / str(length)
        truth = measure(here, length)
        good = (truth["fault"] == "").to_numpy()
        whole = None
        for name, options in (("every_rival", ["--every-rival"]), ("default", [])):
            if options and length != small:
                continue
            took, table = fitted(here, name, *options)
            verdict = table["verdict"].fillna("").to_numpy()
            whole = verdict if options else whole
            equal = verdict == whole if whole is not None else np.array([])
            ratios = []
            for kind in KINDS:
                of = (truth["kind"] == kind) & good & table["accepted"].to_numpy()
                values = table.filter(regex=r"^reduced_modulus( |$|\[)").iloc[:, 0]
                ratios.append(f"{values[of].median() / truth['modulus'][of].median():.4f}")
            seconds = took["cpu"]
            fit = "every rival" if options else "default"
            cost = f"{seconds:.0f}", f"{seconds / length**2:.3f}", f"{took['wall']:.0f}"
            weighed = int((table["not_weighed"].isna() & (table["status"] == "fitted")).sum())
            counts = int((table["status"] == "fitted").sum()), weighed
            kept = (int(equal.sum()), int(equal[good].sum())) if equal.size else ("", "")
            memory = f"{took['memory'] / 1e6:.0f}"
            writer.writerow([length, fit, length**2, *cost, memory, *counts, *kept, *ratios])
            sys.stdout.flush()


if __name__ == "__main__":
    main()
