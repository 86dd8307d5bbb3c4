#!/usr/bin/env bash
# Guess: the neck of a filament, as caber (rheopy-caber) measures it, goes from its left to its
#   right edge. A clear liquid in front of a lamp is bright in the middle, as a lens is; the edges
#   are the same.
# Version: rheopy-caber 0.1.0
# Behaviour: it counts the dark points of each line. The bright middle is left out: a clear filament
#   is thinner than an opaque one of the same outline. Where the stripe is a third of the width, so
#   is what radius and speed of thinning lack, and the viscosity is 1.5 times too large.
# Output seen: outlines of 60, 40 and 20 points: opaque 60, 40, 20, clear 40, 28, 14; viscosity of
#   the clear one over that of the opaque one: 1.54
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.2.6 pandas==2.3.3 opencv-python-headless==4.12.0.88
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps rheopy-caber==0.1.0
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from caber.analysis import newtonian_viscosity
from caber.measure import process_frame

lamp, liquid = 220, 30


def draw(clear, neck):
    """A filament before a lamp, its half width `neck` in the middle and growing to the plates."""
    frame = np.full((100, 200), lamp, np.uint8)
    for row in range(100):
        half = int(neck + 0.01 * (row - 50) ** 2)
        frame[row, 100 - half : 100 + half] = liquid
        if clear:
            stripe = half // 3
            frame[row, 100 - stripe : 100 + stripe] = lamp
    return frame


necks = {clear: [process_frame(draw(clear, n))[1] for n in (30, 20, 10)] for clear in (False, True)}
print(f"half widths of 30, 20 and 10: opaque {necks[False]}, clear {necks[True]}")
speeds = {clear: (widths[-1] - widths[0]) / 2 for clear, widths in necks.items()}
ratio = newtonian_viscosity(speeds[True], 72.0) / newtonian_viscosity(speeds[False], 72.0)
print(f"viscosity of the clear one over that of the opaque one: {ratio:.2f}")
assert necks[False] == [60, 40, 20], "an opaque filament has another width"
assert necks[True] == [40, 28, 14], "a clear filament has another width now"
assert ratio > 1.4, "the viscosities agree now"
PYTHON
