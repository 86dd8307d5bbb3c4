#!/usr/bin/env bash
# Guess: the mean pressure that hertz_full of slippy returns is the load over the contact area that
#   stands beside it: 2/3 of the largest one for a point, pi/4 of it for a line contact.
# Version: slippy 0.5.2 (for Python 3.11, with newer packages than the ones it asks for)
# Behaviour: for a sphere it is. For a line contact it is the load over half the width: 1.57 times
#   the largest pressure. For an ellipse it is the largest pressure over the area, in Pa/m^2.
# Output seen: mean over largest pressure: sphere 0.667, line 1.571, ellipse 71147 (area 1.4e-05
#   m^2)
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
from slippy.contact import hertz_full

rubber = {"moduli": [1e6, 1e30], "v": [0.3, 0.3], "load": 1.0}
sphere = hertz_full(0.01, float("inf"), **rubber)
line = hertz_full([0.01, float("inf")], float("inf"), line=True, **rubber)
ellipse = hertz_full([0.01, 0.02], float("inf"), **rubber)
shares = [found["mean_pressure"] / found["max_pressure"] for found in (sphere, line, ellipse)]
print("mean over largest pressure: sphere {:.3f}, line {:.3f}, ellipse {:.0f}".format(*shares))
area = ellipse["contact_area"]
print(f"area {area:.1e} m^2")
assert np.isclose(shares[0], 2 / 3), "the sphere is wrong, too"
assert np.isclose(ellipse["max_pressure"], 1.5 / area), "the largest pressure is wrong, too"
assert np.isclose(shares[1], np.pi / 2), "the line has another mean now"
assert np.isclose(shares[2], 1 / area), "the ellipse has another mean now"
PYTHON
