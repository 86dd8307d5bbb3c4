#!/usr/bin/env bash
# Guess: HayesElasticModel of biomomentum checks the curve against a parabola and calls it invalid
#   where R squared is less than Rsq_req, usually 0.95; a curve without noise is valid.
# Version: biomomentum 0.1.10
# Behaviour: the check squares the fitted force, not the misfit, so it depends on the size of the
#   force in newtons: curves below about two newtons are invalid, G = E = -1, noise or not; above,
#   all are valid, noise or not. The adjusted R squared that comes back is another one and right.
# Output seen: 0.19 N, no noise: G = -1.00 MPa; 18.9 N, no noise: 9.66 MPa (true 10), R squared
#   1.00; the same with noise of half the force: 15.94 MPa, R squared 0.58
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check biomomentum==0.1.10 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from biomomentum.analysis_static import HayesElasticModel

depth, noise = np.linspace(0, 0.5, 51), np.random.default_rng(0).normal(size=51)


def fit(modulus, amount):
    force = 8 / 3 * modulus * depth**1.5 / (1 - 0.5)  # sphere of 1 mm on a half-space, N
    force += amount * force.max() * noise
    modulus_found, _, _, squared = HayesElasticModel(
        1000 + depth, force, False, 0.9, 1.0, 0.5, 0.95, sampleThickness=1000.0,
        spherical_indenter=True,
    )
    return force.max(), modulus_found, squared


weak, strong, noisy = fit(0.1, 0), fit(10.0, 0), fit(10.0, 0.5)
for name, values in [("weak", weak), ("strong", strong), ("noisy", noisy)]:
    print("{}: {:.2f} N, G = {:.2f} MPa, R squared".format(name, *values[:2]), values[2])
assert np.isclose(strong[1], 10, rtol=0.05), "a strong curve without noise is invalid, too"
assert weak[1] == -1, "a weak curve without noise is valid now"
assert noisy[1] > 0 and noisy[2] < 0.6, "a noisy curve is invalid now"
PYTHON
