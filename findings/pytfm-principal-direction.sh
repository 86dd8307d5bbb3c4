#!/usr/bin/env bash
# Guess: phi_n, "angle of maximal principal stress" of all_stress_measures in pyTFM, points along
#   the largest tension: the stress on a cut across it is sigma_max.
# Version: pyTFM 1.3.5 (without clickpoints, solidspy and openpiv, which this function does not use)
# Behaviour: it is half an arctan of a quotient, which cannot tell sigma_x > sigma_y from the
#   opposite. Where sigma_y is the larger one the angle is that of the smallest tension, 90 degrees
#   off. sigma_max itself is right everywhere.
# Output seen: tension at 20 degrees: phi_n 20.0, stress along it 3.00 (sigma_max 3.00); tension at
#   70 degrees: phi_n -20.0, stress along it 1.00 (sigma_max 3.00)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==1.26.4 scipy==1.11.4 matplotlib==3.8.4 natsort==8.4.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps pyTFM==1.3.5
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from pyTFM.stress_functions import all_stress_measures

largest, smallest = 3.0, 1.0


def measure(degrees):
    along = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    across = np.array([-along[1], along[0]])
    stress = largest * np.outer(along, along) + smallest * np.outer(across, across)
    found = all_stress_measures(stress[None, None])
    angle = float(found[4][0, 0])
    normal = np.array([np.cos(angle), np.sin(angle)])
    assert np.isclose(found[0][0, 0], largest), "the largest stress is wrong, too"
    tension = float(normal @ stress @ normal)
    print(f"tension at {degrees} degrees: phi_n {np.degrees(angle):.1f}, stress along it "
          f"{tension:.2f} (sigma_max {found[0][0, 0]:.2f})")
    return np.degrees(angle), tension


flat, steep = measure(20), measure(70)
assert np.allclose(flat, (20, largest)), "the direction near the x axis is wrong, too"
assert np.allclose(steep, (-20, smallest)), "the direction near the y axis is another one now"
PYTHON
