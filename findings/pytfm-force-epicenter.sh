#!/usr/bin/env bash
# Guess: contractillity of pyTFM sums the forces towards the force epicenter, "the point that
#   maximizes the contractile force". Where all tractions point at one point, it is that one, and
#   the contractile force is the sum of their magnitudes.
# Version: pyTFM 1.3.5 (without clickpoints and solidspy, which this function does not use; with a
#   newer OpenPIV than the one it asks for)
# Behaviour: the equations for that point mix tractions in Pa with forces in N, which are 1e13 times
#   as small: what is left is the mean position, weighted with the square of the tractions. A cell
#   that pulls harder on one side has its centre there, and a contractile force that is too small.
# Output seen: tractions that point at (30, 50): epicenter (29.9, 62.4), contractile force 0.946 of
#   the sum of their magnitudes
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==1.26.4 scipy==1.11.4 \
    matplotlib==3.8.4 natsort==8.4.0 openpiv==0.25.3 scikit-image==0.26.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps pyTFM==1.3.5
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from pyTFM.TFM_functions import contractillity

pixel = 0.5  # um
meeting = np.array([30.0, 50.0])  # x and y in pixels


def pull(adhesions):
    traction = np.zeros((2, 101, 101))  # Pa, along x and y
    for x, y, magnitude in adhesions:
        towards = meeting - (x, y)
        traction[:, y, x] = magnitude * towards / np.hypot(*towards)
    force, _, _, centre = contractillity(*traction, pixel, np.ones((101, 101)))
    share = force / (np.hypot(*traction).sum() * (pixel * 1e-6) ** 2)
    print(f"epicenter ({centre[0]:.1f}, {centre[1]:.1f}), contractile force {share:.3f} of the sum "
          "of the magnitudes")
    return centre, share


even = [(10, 50, 500), (50, 50, 500), (30, 30, 500), (30, 70, 500)]
uneven = [(10, 50, 1000), (30, 20, 500), (90, 50, 300), (30, 90, 800), (70, 80, 600)]
centre, share = pull(even)
assert np.allclose(centre, meeting) and np.isclose(share, 1), "even tractions are wrong, too"
centre, share = pull(uneven)
assert np.allclose(centre, (29.91, 62.35), atol=0.01), "uneven tractions have another centre now"
assert np.isclose(share, 0.946, atol=1e-3), "uneven tractions have another force now"
PYTHON
