#!/usr/bin/env bash
# Guess: a mask of slippy's roughness() chooses the same points for every parameter, and leaves the
#   heights as they are.
# Version: slippy 0.5.2 (for Python 3.11, with newer packages than the ones it asks for)
# Behaviour: for Sq and Sa True is what is evaluated, for the summits (Sds, Ssc) True is what is
#   left out. Half a surface, marked, has the Sq of one half and the summits of the other, divided
#   by the points of the first. And with no_flattening=True the marked heights of the caller's
#   array are nan afterwards.
# Output seen: right half marked, summits there 6, in the left half 3: Sq that of the right half,
#   Sds times points 3; 2048 heights nan
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==1.26.4 scipy==1.11.4 numba==0.59.1 sympy==1.12 matplotlib==3.8.4 tinydb==4.8.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps slippy==0.5.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from slippy.surface import roughness

rows, columns = np.mgrid[:64, :64]
heights = np.zeros((64, 64))
right = columns >= 32
for row, column in [(10, 10), (30, 20), (50, 10)]:  # three hills at the left, six at the right
    heights += np.exp(-((rows - row) ** 2 + (columns - column) ** 2) / 8)
for row, column in [(10, 40), (10, 55), (30, 40), (30, 55), (50, 40), (50, 55)]:
    heights += 2 * np.exp(-((rows - row) ** 2 + (columns - column) ** 2) / 8)
before = heights.copy()


def evaluate(name):
    return float(roughness(heights, name, grid_spacing=1.0, mask=right, no_flattening=True))


share = evaluate("sq") / np.sqrt(np.mean(before[right] ** 2))
summits = evaluate("sds") * right.sum()
lost = int(np.isnan(heights).sum())
print(f"Sq over that of the right half {share:.3f}, summits {summits:.0f}, {lost} heights nan")
assert np.isclose(share, 1), "Sq is that of the left half now"
assert np.isclose(summits, 3), "the summits are those of the right half now"
assert lost == right.sum(), "the heights are kept now"
PYTHON
