#!/usr/bin/env bash
# Guess: the effective modulus that tribology's eeff() gives goes into all its Hertz functions.
# Version: tribology 0.5.16, without the versions of numpy and OpenCV that it asks for, which no
#   Python of today has
# Behaviour: eeff() is twice the contact modulus E* (1/E* = sum (1 - nu^2)/E), as rolling bearings
#   have it. Contact area and pressure expect that; the displacement, dhertz(), expects E* and
#   comes out 37 % too small. Half of eeff() gives the displacement.
# Output seen: sphere on a plane: radius of contact over Hertz's 1.000, displacement over Hertz's
#   0.630; with eeff() / 2 1.000
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps tribology==0.5.16
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.2.6 scipy==1.17.1 numexpr==2.14.2 matplotlib==3.11.2 opencv-python-headless==4.12.0.88
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from math import inf, isclose

import tribology

radius, modulus, ratio, force = 5e-3, 1e6, 0.5, 1e-3
contact_modulus = modulus / (1 - ratio**2)
contact = (3 * force * radius / (4 * contact_modulus)) ** (1 / 3)
displacement = contact**2 / radius

effective = tribology.eeff(modulus, ratio, 1e30, 0.3)  # against a rigid body
found = tribology.ahertz(*tribology.reff(radius, radius, inf, inf), effective, force)[0]
moved = tribology.dhertz(effective, radius, radius, inf, inf, force)
halved = tribology.dhertz(effective / 2, radius, radius, inf, inf, force)
print(f"radius {found / contact:.3f}, displacement {moved / displacement:.3f}, "
      f"with half the modulus {halved / displacement:.3f} of Hertz's")
assert isclose(effective, 2 * contact_modulus, rel_tol=1e-6), "another effective modulus"
assert isclose(found, contact, rel_tol=1e-3), "the contact area is wrong, too"
assert isclose(halved, displacement, rel_tol=1e-3), "half of it does not help any more"
assert isclose(moved, displacement / 2 ** (2 / 3), rel_tol=1e-3), "another displacement"
PYTHON
