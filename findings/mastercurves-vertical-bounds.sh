#!/usr/bin/env bash
# Guess: Multiply(bounds=(0.9, 1.1)) of mastercurves keeps a vertical shift within 10 % of 1, as it
#   keeps a horizontal one.
# Version: mastercurves 0.2.3
# Behaviour: the bounds of the only vertical shift, where the data are logarithms, are not used: it
#   is computed in closed form. Where density and temperature allow for 10 %, it takes any factor,
#   and a curve that does not superpose looks as if it did. Horizontal shifts keep theirs.
# Output seen: curves a factor of 3 apart, bounds of 0.9 and 1.1: vertical shift 3.00, horizontal
#   shift 1.10
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check mastercurves==0.2.3 \
    numpy==2.4.6 scipy==1.17.1 scikit-learn==1.9.0 pandas==2.3.3 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from mastercurves import MasterCurve
from mastercurves.transforms import Multiply

log_rate = np.log(np.geomspace(0.1, 100, 30))
narrow = {"bounds": (0.9, 1.1)}


def modulus(log_rate):
    return 0.5 * log_rate + 3 * np.tanh(log_rate / 2)


def shift(first, second, vertical):
    curve = MasterCurve()
    curve.add_data([log_rate, log_rate], [first, second], [20.0, 30.0])
    if vertical:
        curve.add_vtransform(Multiply(**narrow))
    else:
        curve.add_htransform(Multiply(**narrow))
    curve.superpose()
    return float((curve.vparams if vertical else curve.hparams)[0][1])


upright = shift(modulus(log_rate), modulus(log_rate) - np.log(3), True)
lying = shift(modulus(log_rate), modulus(log_rate + np.log(3)), False)
print(f"vertical shift {upright:.2f}, horizontal shift {lying:.2f}")
assert 0.89 < lying < 1.11, "the bounds of horizontal shifts are not kept, either"
assert np.isclose(upright, 3, rtol=0.02), "the bounds of vertical shifts are kept now"
PYTHON
