#!/usr/bin/env bash
# Guess: HankelTransform of discrete-hankel-transform, given the largest radius, transforms: values
#   on its grid r give the integral of f r J0(k r) dr on its grid k.
# Version: discrete-hankel-transform 0.1.0
# Behaviour: the radius scales the two grids and the weights of the sums, not the transform. What
#   comes out is the integral over r_max^2, right for a radius of 1 only; back and forth it
#   cancels, so a test of the round trip passes. A factor in between, such as the compliance
#   2 / (E* k), is right as well; the values at given k are not.
# Output seen: found over true at the smallest k: r_max 1: 1.000, r_max 10: 0.010; round trip 1.000
#   and 1.000
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==2.4.6 scipy==1.17.1
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps \
    discrete-hankel-transform==0.1.0
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from discrete_hankel_transform import HankelTransform

seen = {}
for radius in (1.0, 10.0):
    transform, width = HankelTransform(64, r_max=radius), radius / 10
    values = np.exp(-((transform.r / width) ** 2))
    found = transform.forward(values)
    true = width**2 / 2 * np.exp(-((transform.k * width) ** 2) / 4)
    back = transform.backward(found) / values
    seen[radius] = found[0] / true[0], back[0]
    print(f"r_max {radius:.0f}: found over true {seen[radius][0]:.3f}, round trip {back[0]:.3f}")
assert np.allclose(seen[1.0], 1, rtol=1e-6), "a radius of 1 is wrong, too"
assert np.isclose(seen[10.0][1], 1, rtol=1e-6), "the round trip is wrong, too"
assert np.isclose(seen[10.0][0], 0.01, rtol=1e-6), "the radius scales the transform now"
PYTHON
