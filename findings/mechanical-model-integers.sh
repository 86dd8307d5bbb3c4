#!/usr/bin/env bash
# Guess: a solid of 0.8 Pa in mechanical-model has a storage modulus of 0.8 Pa at every frequency,
#   whatever the frequencies are written as.
# Version: mechanical-model 0.0.1
# Behaviour: the modulus is put into an array of the frequencies' kind. At 1, 2, 3 rad/s, written as
#   integers, that of KelvinVoigt and Elastic is cut to 0 Pa, 1.9 Pa to 1 Pa; so is the compliance
#   of Elastic at integer times. The loss modulus and tan delta, computed apart, are right, and
#   their ratio is not the storage modulus.
# Output seen: 1.0, 2.0 rad/s: 0.8 0.8 Pa; 1, 2 rad/s: 0 0 Pa; loss modulus over tan delta 0.8
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    mechanical-model==0.0.1 numpy==2.4.6 scipy==1.17.1 mpmath==1.3.0
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from mechanical_model.linear_mech import Elastic, KelvinVoigt

solid = KelvinVoigt(G=0.8, eta=0.1)
floats, integers = np.array([1.0, 2.0]), np.array([1, 2])
right, cut = solid.Gp(floats), solid.Gp(integers)
ratio = solid.Gpp(integers) / solid.tandelta(integers)
print("floats", *right, "Pa; integers", *cut, "Pa; loss modulus over tan delta", *ratio)
assert np.allclose(right, 0.8), "at floats it is wrong, too"
assert np.allclose(ratio, 0.8), "the loss modulus is wrong, too"
assert np.array_equal(cut, [0, 0]), "at integers the modulus is not cut any more"
assert np.array_equal(Elastic(1.9).Gp(integers), [1, 1]), "Elastic is not cut any more"
assert np.array_equal(Elastic(1.9).J(integers), [0, 0]), "its compliance is not cut any more"
PYTHON
