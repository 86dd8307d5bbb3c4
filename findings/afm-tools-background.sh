#!/usr/bin/env bash
# Guess: fit_background of afm-tools takes a polynomial background off an image of any shape.
# Version: afm-tools 2.1.4
# Behaviour: of a square one only. In an image with more columns than rows, or fewer, the heights
#   are fitted in one order and the background is taken off in another: a tilted plane comes back
#   with larger heights than before. flatten_plane beside it is right.
# Output seen: tilted plane, rms after over before: 64 x 64 0.00, 64 x 128 2.06, 128 x 64 1.22;
#   flatten_plane 0.00
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check afm-tools==2.1.4 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from afm_tools.afm_image_analyzer import fit_background, flatten_plane

left = {}
for shape in [(64, 64), (64, 128), (128, 64)]:
    row, column = np.indices(shape)
    plane = 0.1 * column + 0.05 * row
    flattened, _ = fit_background(plane)
    left[shape] = flattened.std() / plane.std()
    print(f"{shape[0]} x {shape[1]}: rms after over before {left[shape]:.2f}")
    assert flatten_plane(plane).std() < 1e-9, "flatten_plane is wrong, too"
assert left[64, 64] < 1e-3, "a square image is wrong, too"
assert left[64, 128] > 1 and left[128, 64] > 1, "other shapes are right now"
PYTHON
