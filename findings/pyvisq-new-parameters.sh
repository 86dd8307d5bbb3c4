#!/usr/bin/env bash
# Guess: a model of pyvisq that gets other parameters, model.params = ..., responds with them.
# Version: pyvisq 1.2.2
# Behaviour: the relaxation modulus is kept for each time that was asked before, so it is the old
#   one there and the new one in between. The compliance is that of the elements that the model
#   began with, old at all times. A fit that sets parameters in a loop sees no change at its own
#   times. A new object is right.
# Output seen: after a change of k from 1 to 5: G(1.0) = 0.905 (a new model 3.033), G(1.5) = 2.362
#   (2.362), J(1.0) = 1.100 (0.300)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pyvisq==1.2.2 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from pyvisq.models.elements import DashpotParams, SpringParams
from pyvisq.models.maxwell import Maxwell, MaxwellParams


def describe(spring):
    return MaxwellParams(DashpotParams(10.0), SpringParams(spring))


def respond(model):
    return np.array([model.G(1.0), model.G(1.5), model.J(1.0)], dtype=float)


changed, new = Maxwell(describe(1.0)), Maxwell(describe(5.0))
old = changed.G(1.0)
changed.params = describe(5.0)
kept, fresh = respond(changed), respond(new)
for name, values in [("changed", kept), ("new", fresh)]:
    print("{}: G(1.0) = {:.3f}, G(1.5) = {:.3f}, J(1.0) = {:.3f}".format(name, *values))
modulus = 5 * np.exp(-0.5 * np.array([1, 1.5]))
assert np.allclose(fresh, [*modulus, 1 / 5 + 1 / 10]), "a new model is wrong, too"
assert np.isclose(kept[0], old), "a time that was asked before is computed again now"
assert np.isclose(kept[1], fresh[1]), "a new time is wrong, too"
assert np.isclose(kept[2], 1 + 1 / 10), "the compliance follows the parameters now"
PYTHON
