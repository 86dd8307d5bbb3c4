#!/usr/bin/env bash
# Guess: a spring constant given in meta_override replaces the one of the file, so the force is
#   scaled by the ratio, or the override is refused.
# Version: afmformats 0.18.7
# Behaviour: with AFM Workshop it depends on the unit of a column. Where the file has volts, the
#   force is scaled; where the same curve was exported as nN, it is not, and the metadata hold the
#   new value all the same. Deflection computed from the two, F / k, is then wrong by the ratio.
#   The loaders of HDF5, .tab and .ibw refuse the override; so one loop over mixed files gives
#   three answers.
# Output seen: volts: 1.0 nN, with 0.1 N/m 2.0 nN; nN: 1.0 nN, with 0.1 N/m 1.0 nN; metadata 0.1
#   N/m in both
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check afmformats==0.18.7 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from pathlib import Path

import afmformats
import numpy as np

header = """Force-Distance Curve
File Format: 3

Mode: Single
Point: 1
X, um: 1
Y, um: 1
Light Lever Gain, mV/nm: 20
Force Constant, nN/nm: 0.05

"""
height, volts = 1000 + 10 * np.arange(5.0), 0.1 * np.arange(5.0)


def largest_force(name, column, values, override):
    names = ["Extend Z-Sense(nm)", f"Extend {column}", "Retract Z-Sense(nm)", f"Retract {column}"]
    rows = [f"{z},{v},{z},{v}" for z, v in zip(height, values)]
    Path(name).write_text(header + "\n".join([",".join(names), *rows]))
    curve = afmformats.load_data(name, meta_override=override)[0]
    return 1e9 * curve["force"].max(), curve.metadata["spring constant"]


seen = {}
for name, column, values in [
    ("volts.csv", "T-B(V)", volts),
    ("newtons.csv", "Force(nN)", volts / 20e-3 * 0.05),
]:
    for override in (None, {"spring constant": 0.1}):
        force, constant = largest_force(name, column, values, override)
        print(f"{name}: {force:.2f} nN, {constant} N/m")
        seen[name, override is not None] = force, constant
assert np.isclose(seen["volts.csv", False][0], seen["newtons.csv", False][0]), "different curves"
assert np.allclose(seen["volts.csv", True], (2, 0.1)), "volts are not scaled any more"
assert np.allclose(seen["newtons.csv", True], (1, 0.1)), "newtons are scaled, or refused, now"
PYTHON
