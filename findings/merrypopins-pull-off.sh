#!/usr/bin/env bash
# Guess: default_preprocess of merrypopins, "remove early data up to the minimum load point, detect
#   contact", leaves the loading and unloading of a curve.
# Version: merrypopins 1.1.2
# Behaviour: the minimum is looked for in the whole curve. Where the tip sticks at the end, as it
#   does on soft or sticky samples, the smallest load is that of pull-off, and all before it, the
#   whole test, is removed. A tail of baseline comes back, whose noise is then scaled to a contact;
#   only a minimum in the very last row is warned about.
# Output seen: of 400 uN: without adhesion 400 uN in 1733 of 2000 rows, with a pull-off of 5 uN
#   0.6 uN in 156 rows
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check merrypopins==1.1.2 \
    numpy==2.4.6 pandas==3.1.1 scipy==1.17.1 scikit-learn==1.9.1 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" - 2> log.txt << 'PYTHON'
import numpy as np
import pandas as pd
from merrypopins.preprocess import default_preprocess

rows = 2000
way = np.concatenate([np.linspace(-100, 400, rows // 2), np.linspace(400, -100, rows // 2)])
depth = np.maximum(way, 0)
back = np.arange(rows) >= rows // 2


def preprocess(pull_off):
    load = 0.05 * depth**1.5 + 0.2 * np.random.default_rng(1).normal(size=rows)
    load[back] -= np.where(way[back] > -30, pull_off * (1 - depth[back] / 400), 0)
    curve = pd.DataFrame(
        {"Time (s)": np.arange(rows) / 100, "Depth (nm)": way + 25, "Load (µN)": load}
    )
    left = default_preprocess(curve)
    largest = left["Load (µN)"].max()
    print(f"pull-off {pull_off} uN: {largest:.1f} uN in {len(left)} of {rows} rows")
    return largest, len(left)


without, sticky = preprocess(0.0), preprocess(5.0)
assert without[0] > 399 and without[1] > 1500, "without adhesion it is wrong, too"
assert sticky[0] < 5 and sticky[1] < 300, "the loading is kept now"
PYTHON
