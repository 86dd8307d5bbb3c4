#!/usr/bin/env bash
# Guess: Sdr of slippy, the developed area ratio, is 0 for a flat surface and positive for others;
#   Sz, the ten point height, is a number.
# Version: slippy 0.5.2 (for Python 3.11, with newer packages than the ones it asks for)
# Behaviour: the area of the (n - 1)^2 cells between the points is compared with that of n^2, and
#   divided by the former: a flat surface of 10 x 10 points has -0.23, of 100 x 100 points -0.02,
#   as large as the true one of many surfaces. Sz is an array of five: only the heights of the
#   summits are divided by 5, and none of the two are summed.
# Output seen: flat -0.235 and -0.020; waves -0.011 (true 0.021); Sz 1.2 1.2 1.2 1.2 1.19
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


def developed(heights):
    return float(roughness(heights, "sdr", grid_spacing=1.0, no_flattening=True))


small, large = developed(np.zeros((10, 10))), developed(np.zeros((100, 100)))
x, y = np.meshgrid(np.arange(64.0), np.arange(64.0))
waves = np.sin(x / 3) * np.cos(y / 4)
found = developed(waves)
slopes = np.gradient(waves)
true = float(np.mean(np.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2)) - 1)
ten = np.asarray(roughness(waves, "sz", grid_spacing=1.0))
print(f"flat {small:.3f} and {large:.3f}; waves {found:.3f} (true {true:.3f}); Sz",
      *np.round(ten, 2))
flat = [1 - 100 / 81, 1 - 1e4 / 99**2]
assert np.allclose([small, large], flat), "a flat surface has another one now"
assert found < 0 < true, "waves have a positive one now"
assert abs(found - 1 + (64 / 63) ** 2 / (1 + true)) < 0.003, "waves have another one now"
assert ten.shape == (5,), "the ten point height is one number now"
PYTHON
