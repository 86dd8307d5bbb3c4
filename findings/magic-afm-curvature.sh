#!/usr/bin/env bash
# Guess: the "Curvature" that Magic AFM computes of an image is the mean curvature, 1/R on a sphere,
#   or else the Gaussian one, 1/R^2 wherever one looks.
# Version: magic-afm 1.0.0b3
# Behaviour: it is the Gaussian one without the square of its denominator: on a sphere it grows with
#   the slope, 1/R^2 at the top and twice that at 45 degrees. Ridges have none at all. The
#   image's borders are expected in nm, its heights in m.
# Output seen: sphere of 1 um: 1.00 um^-2 at the top, 1.64 um^-2 at a slope of 39 degrees; cylinder
#   of 1 um: 0.00
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    magic-afm==1.0.0b3 numpy==2.4.6 soxr==1.1.0 psutil==7.2.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from magic_afm.calculation import MANIPULATIONS

radius, count = 1e-6, 201
line = np.linspace(-0.63e-6, 0.63e-6, count)
x, y = np.meshgrid(line, line)
step = 1e9 * (line[1] - line[0])
borders = 2 * (1e9 * line[0], 1e9 * line[-1] + step)  # nm

sphere = MANIPULATIONS["Curvature"](np.sqrt(radius**2 - x**2 - y**2), *borders)
cylinder = MANIPULATIONS["Curvature"](np.sqrt(radius**2 - x**2), *borders)
middle, aside = (count // 2, count // 2), (30, 30)
distance = np.hypot(x[aside], y[aside])
slope = distance / np.sqrt(radius**2 - distance**2)
top, off = 1e-12 * sphere[middle], 1e-12 * sphere[aside]
ridge = 1e-12 * cylinder[middle]
angle = np.rad2deg(np.arctan(slope))
print(f"sphere: {top:.2f} um^-2 at the top, {off:.2f} at {angle:.0f} degrees")
print(f"cylinder: {ridge:.2f} um^-2")
assert np.isclose(top, 1, rtol=0.01), "another curvature at the top"
assert np.isclose(off, 1 + slope**2, rtol=0.01), "it is the same everywhere on a sphere now"
assert abs(ridge) < 1e-6, "a ridge has a curvature now"
PYTHON
