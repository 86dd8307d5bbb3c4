#!/usr/bin/env bash
# Guess: HertzModel of pyfmrheo fits the contact point (delta0) along with the modulus.
# Version: pyfmrheo 0.1.3
# Behaviour: the model moves the contact point to the nearest row, so a small step of delta0
#   changes nothing; the search sees no slope and leaves it near its start. A start that is 50 nm
#   off in a curve of 500 nm is a modulus 15 to 20 % off, with R squared above 0.99 and no
#   warning. Only a start in the right row gives the right modulus.
# Output seen: right start: contact 0.0 nm off, E = 1000 Pa; 50 nm before it: -44.0 nm, 853 Pa, R
#   squared 0.996; 50 nm after it: 50.0 nm, 1215 Pa, R squared 0.994; true 1000 Pa
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
modulus, radius, contact = 1000.0, 5e-6, 50e-9


def fit(start):
    indentation = np.linspace(-1e-6, 0.55e-6, 1551)  # rows 1 nm apart, contact at 50 nm
    depth = np.clip(indentation - contact, 0, None)
    force = 4 / 3 * np.sqrt(radius) * modulus / (1 - 0.5**2) * depth**1.5
    model = HertzModel("paraboloid", radius)
    model.delta0_init = start
    model.fit(indentation, force)
    return 1e9 * (model.delta0 - contact), model.E0, model.Rsquared


right, before, after = (fit(contact + error) for error in (0.0, -50e-9, 50e-9))
for name, values in [("right start", right), ("before", before), ("after", after)]:
    print("{}: contact {:.1f} nm off, E = {:.0f} Pa, R squared {:.3f}".format(name, *values))
assert np.isclose(right[1], modulus, rtol=1e-3), "a right start is wrong, too"
for found, fitted, squared in (before, after):
    assert abs(found) > 30, "the contact point is fitted now"
    assert abs(fitted / modulus - 1) > 0.1, "another modulus"
    assert squared > 0.99, "the misfit is seen now"
PYTHON
