#!/usr/bin/env bash
# Guess: a spherical Tip of micromechanics takes the prefactors that its documentation names,
#   [-pi, 2 pi R] with R in nm, of A = pi (2 R h - h^2).
# Version: micromechanics 1.3.5
# Behaviour: they are radius in um and opening angle in degrees of the cone behind the sphere.
#   The documented ones are taken without a word; the area is 0.04 to 10 times the true one. With
#   [R in um, 0] it is right. The other shape with prefactors, "iso", has them in nm.
# Output seen: R = 5 um, depths of 10 nm, 100 nm, 1 um, area over the true one: [-pi, 2 pi R] 0.04,
#   0.65, 9.97; [5, 0] 1.00, 1.00, 1.00
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    micromechanics==1.3.5 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from micromechanics.indentation.tip import Tip

radius, depth = 5.0, np.array([0.01, 0.1, 1.0])  # um
true = np.pi * (2 * radius * depth - depth**2)
documented = Tip(shape=[-np.pi, 2 * np.pi * 1000 * radius, "sphere"])
taken = Tip(shape=[radius, 0.0, "sphere"])
wrong, right = (tip.areaFunction(depth.copy()) / true for tip in (documented, taken))
print("area over the true one: [-pi, 2 pi R]", np.round(wrong, 2), "[R, 0]", np.round(right, 2))
assert np.allclose(right, 1), "radius and angle are wrong, too"
assert wrong[0] < 0.2 and wrong[2] > 5, "the documented prefactors have another result now"
PYTHON
