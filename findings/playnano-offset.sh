#!/usr/bin/env bash
# Guess: the two methods of align_frames in playNano find the same drift, one faster than the other;
#   and the same drift, whatever height the images lie at.
# Version: playnano 0.5.0 (without its windows)
# Behaviour: "full_cross_correlation" does not take the mean off, as "fft_cross_correlation" does,
#   and fills with zeros around the images. Where the heights lie well above zero, the product is
#   largest where the images overlap most: no drift is found and none is taken off.
# Output seen: drift of 4 rows and -3 columns, both methods on heights around zero: 4 -3; on heights
#   20 nm higher: fft_cross_correlation 4 -3, full_cross_correlation 0 0
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==1.26.4 scipy==1.15.3 \
    scikit-image==0.25.2 matplotlib==3.10.3
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps playnano==0.5.0
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from playnano.processing.video_processing import align_frames

row, column = np.mgrid[:48, :48]
methods = ("fft_cross_correlation", "full_cross_correlation")


def draw(down, right):
    spots = [(20, 24, 3.0), (28, 19, 2.0), (30, 30, 2.5)]  # molecules on a flat surface, nm
    return sum(height * np.exp(-((row - y - down) ** 2 + (column - x - right) ** 2) / 8)
               for y, x, height in spots)


frames = np.stack([draw(0, 0), draw(-4, 3)])
frames -= frames.mean()
found = {}
for offset in (0.0, 20.0):
    for method in methods:
        _, notes = align_frames(frames + offset, method=method)
        found[offset, method] = tuple(int(value) for value in notes["shifts"][1])
        print(f"heights around {offset:.0f} nm, {method}:", *found[offset, method])
fast, full = methods
assert found[0.0, fast] == found[0.0, full] == (4, -3), "heights around zero are wrong, too"
assert found[20.0, fast] == (4, -3), "the fast method is wrong, too"
assert found[20.0, full] == (0, 0), "the full method finds another drift now"
PYTHON
