#!/usr/bin/env bash
# Guess: the uncertainty that mastercurves gives with a vertical shift is its standard deviation: it
#   is about the scatter of the shifts of repeated measurements.
# Version: mastercurves 0.2.3
# Behaviour: it is the shift times the square root of the relative standard deviation, not times the
#   deviation. One of 1 % comes out as 10 %, one of 0.01 % as 1 %: the better the data, the more it
#   is too large. Four times the noise give twice the uncertainty.
# Output seen: 30 repeats, noise 4 %: scatter 0.030, uncertainty 0.233; the square root of the
#   relative scatter, times the shift: 0.300; four times the noise: 1.99 times the uncertainty
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

random = np.random.default_rng(1)
log_rate = np.log(np.geomspace(0.1, 100, 30))
log_modulus = 0.5 * log_rate + 3 * np.tanh(log_rate / 2)


def repeat(noise):
    """A shift by a factor of 3 and its uncertainty, for one pair of noisy curves."""
    curve = MasterCurve(fixed_noise=noise)
    first, second = noise * random.normal(size=(2, len(log_rate)))
    curve.add_data(
        [log_rate, log_rate], [log_modulus + first, log_modulus - np.log(3) + second], [20.0, 30.0]
    )
    curve.add_vtransform(Multiply())
    curve.superpose()
    return float(curve.vparams[0][1]), float(curve.vuncertainties[0][1])


shifts, uncertainties = np.array([repeat(0.04) for _ in range(30)]).T
scatter, stated = shifts.std(), uncertainties.mean()
rooted = 3 * np.sqrt(scatter / 3)
noisier = np.mean([repeat(0.16)[1] for _ in range(10)])
print(f"scatter {scatter:.3f}, uncertainty {stated:.3f}, square root {rooted:.3f}")
print(f"four times the noise: {noisier / stated:.2f} times the uncertainty")
assert np.isclose(shifts.mean(), 3, rtol=0.02), "the shift itself is wrong"
assert stated > 5 * scatter, "the uncertainty is about the scatter now"
assert 1.6 < noisier / stated < 2.4, "it grows with the noise in another way now"
PYTHON
