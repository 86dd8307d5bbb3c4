#!/usr/bin/env bash
# Guess: filter_lowpass of pySPM lets waves pass that are longer than its limit.
# Version: pySPM 0.6.3 (for Python 3.11 and 3.12)
# Behaviour: with an even number of rows and columns it does. With an odd one it moves the
#   spectrum by one step on the way back and takes the real part: the image is modulated by waves
#   of half the scan, the error as large as the heights. No message.
# Output seen: two long waves, rms 0.79: 100 x 100 points: error 0.00, 101 x 101: error up to 2.96
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pySPM==0.6.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from pySPM import SPM_image

errors = {}
for n in (100, 101):
    y, x = np.mgrid[:n, :n] / n
    heights = np.sin(2 * np.pi * 2 * x) + 0.5 * np.cos(2 * np.pi * 3 * y)
    image = SPM_image(heights.copy(), real={"unit": "m", "x": 1e-4, "y": 1e-4})
    image.filter_lowpass(10)  # waves up to ten per side
    errors[n] = abs(image.pixels - heights).max()
    print(f"{n} x {n} points: rms {heights.std():.2f}, error up to {errors[n]:.2f}")
assert errors[100] < 1e-9, "even sizes are wrong, too"
assert errors[101] > 1, "odd sizes are right now"
PYTHON
