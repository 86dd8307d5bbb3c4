#!/usr/bin/env bash
# Guess: the curves of a map that is exported to HDF5 come back in the order in which they were
#   written.
# Version: afmformats 0.18.7
# Behaviour: they come in the order of their names as text: 0, 1, 10, 11, 2, ... With more than
#   ten curves the third of the list is the eleventh of the map; results that are paired with
#   positions by their place in the list are shuffled. Only `enum` of a curve tells which one it
#   is.
# Output seen: [0, 1, 10, 11, 2, 3, 4, 5, 6, 7, 8, 9]
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check afmformats==0.18.7 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from pathlib import Path

import afmformats
import h5py
import numpy as np

with h5py.File("map.h5", "w") as file:
    for number in range(12):
        curve = afmformats.mod_force_distance.AFMForceDistance(
            {
                "force": np.full(4, float(number)),
                "height (measured)": np.arange(4.0),
                "segment": np.array([0, 0, 1, 1], dtype=np.uint8),
            },
            {"path": Path("map"), "enum": number, "imaging mode": "force-distance"},
        )
        curve.export_data(file, fmt="hdf5")
curves = afmformats.load_data("map.h5")
order = [int(curve["force"][0]) for curve in curves]
print(order)
assert [curve.enum for curve in curves] == order, "enum does not tell the curve any more"
assert order == [0, 1, 10, 11, *range(2, 10)], "the order is another one now"
PYTHON
