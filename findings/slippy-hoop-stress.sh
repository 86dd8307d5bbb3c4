#!/usr/bin/env bash
# Guess: the stresses at the surface below a sphere, stress_surface_axis_b_f of hertz_full in
#   slippy, are the same in all directions along the surface in the middle of the contact, and
#   those of stress_z_axis_b_f at no depth.
# Version: slippy 0.5.2 (for Python 3.11, with newer packages than the ones it asks for)
# Behaviour: the hoop stress has the wrong sign in one of its two terms: in the middle it is a
#   tension of 0.4 of the largest pressure, where it is a compression of 0.8 (nu = 0.3). All over
#   the contact it is off by 4 nu times the pressure there; at the edge and outside it is right.
# Output seen: middle, over the largest pressure: radial -0.80, hoop 0.40; along the axis -0.80,
#   -0.80; outside 0.13, -0.13
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

ratio = 0.3
found = hertz_full(0.01, float("inf"), moduli=[1e6, 1e30], v=[ratio, ratio], load=1.0)
radius, largest = found["contact_radii"][0], found["max_pressure"]
surface, axis = found["stress_surface_axis_b_f"][0], found["stress_z_axis_b_f"][0]


def share(stresses):
    return [stresses[name] / largest for name in ("sigma_r", "sigma_theta")]


radial, hoop = share(surface(radius * np.array([1e-6, 1.0001])))
below = share(axis(np.array([1e-9 * radius])))
print(f"middle: radial {radial[0]:.2f}, hoop {hoop[0]:.2f}; along the axis {below[0][0]:.2f}, "
      f"{below[1][0]:.2f}; outside {radial[1]:.2f}, {hoop[1]:.2f}")
middle = -(1 + 2 * ratio) / 2
assert np.allclose([radial[0], *below[0], *below[1]], middle, atol=1e-3), "more of them are wrong"
assert np.isclose(hoop[1], -radial[1]), "outside it is wrong, too"
assert np.isclose(hoop[0], middle + 4 * ratio, atol=1e-3), "the hoop stress is another one now"
PYTHON
