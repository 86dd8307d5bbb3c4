#!/usr/bin/env bash
# Guess: the force of a flat punch in pyfmrheo is proportional to the indentation, F = 2 a E d /
#   (1 - nu^2).
# Version: pyfmrheo 0.1.3
# Behaviour: it goes with the square of the indentation, without another length: F = 2 a E d^2 /
#   (1 - nu^2). What is called E0 is a modulus per metre, here six digits too large, and another
#   one for every depth; a straight force curve is fitted by a parabola. The other shapes have the
#   right exponent.
# Output seen: paraboloid 1000 Pa; flat punch: exponent 2.00, 500 nm deep 1.8e+09, 250 nm deep
#   4.3e+09 Pa; true 1000 Pa
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pyfmrheo==0.1.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import warnings

import numpy as np
from pyfmrheo.models.hertz import HertzModel

warnings.simplefilter("ignore")  # it divides by the force, which is zero before contact
modulus, length = 1000.0, 2e-6  # Pa; radius of the sphere and of the punch in m
plane_strain = modulus / (1 - 0.5**2)


def fit(shape, deepest):
    indentation = np.linspace(-deepest, deepest, 1001)  # contact in the middle, at zero
    depth = np.clip(indentation, 0, None)
    paraboloid = 4 / 3 * np.sqrt(length) * plane_strain * depth**1.5
    punch = 2 * length * plane_strain * depth
    model = HertzModel(shape, length)
    model.fit(indentation, {"paraboloid": paraboloid, "flat_punch": punch}[shape])
    return model.E0


sphere = fit("paraboloid", 500e-9)
deep, shallow = fit("flat_punch", 500e-9), fit("flat_punch", 250e-9)
law = HertzModel("flat_punch", length).model(np.array([0, 1e-7, 2e-7]), 0.0, modulus, 0.0)
exponent = np.log2(law[2] / law[1])
print(f"paraboloid {sphere:.0f} Pa; flat punch: exponent {exponent:.2f}, "
      f"500 nm deep {deep:.1e}, 250 nm deep {shallow:.1e} Pa")
assert np.isclose(sphere, modulus, rtol=1e-3), "a paraboloid is wrong, too"
assert np.isclose(exponent, 2), "a flat punch has another law now"
assert deep > 1e6 * modulus, "another modulus"
assert shallow > 1.5 * deep, "the modulus does not depend on the depth any more"
PYTHON
