#!/usr/bin/env bash
# Guess: fit_model() is called again with another tip radius in the parameters, so it fits again.
# Version: nanite 4.2.3
# Behaviour: the curve keeps the Parameters object that it was given and compares the next one
#   with it. Where the same object comes back with another value, nothing differs, and the old
#   result stays without a warning. A loop over radii gives one modulus. A copy of the object is
#   fitted.
# Output seen: R = 5 um: E = 1000 Pa; same object with R = 1.25 um: E = 1000 Pa, R = 5 um; copy
#   with R = 20 um: E = 500 Pa
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check nanite==4.2.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import copy
from pathlib import Path

import numpy as np
from nanite import Indentation

stiffness, radius, modulus, n = 0.05, 5e-6, 1e3, 1000
tip = np.concatenate([np.linspace(2e-6, -5e-7, n), np.linspace(-5e-7, 2e-6, n)])
force = 4 / 3 * modulus / 0.75 * np.sqrt(radius) * np.maximum(-tip, 0) ** 1.5
curve = Indentation(
    {
        "force": force,
        "height (measured)": tip - force / stiffness,
        "segment": np.repeat([0, 1], n).astype(np.uint8),
    },
    {
        "path": Path("curve"),
        "enum": 0,
        "imaging mode": "force-distance",
        "spring constant": stiffness,
    },
)
curve.apply_preprocessing(["compute_tip_position", "correct_force_offset", "correct_tip_offset"])
parameters = curve.get_initial_fit_parameters(model_key="hertz_para")


def fit(parameters, radius):
    parameters["R"].value = radius
    curve.fit_model(model_key="hertz_para", params_initial=parameters, weight_cp=0)
    fitted = curve.fit_properties["params_fitted"]
    print(f"R = {radius} m: E = {fitted['E'].value:.1f} Pa, fitted with {fitted['R'].value} m")
    return fitted["E"].value


first = fit(parameters, 5e-6)
again = fit(parameters, 1.25e-6)
copied = fit(copy.deepcopy(parameters), 20e-6)
assert abs(first / 1e3 - 1) < 0.01, "the first fit is not right any more"
assert again == first, "a changed Parameters object is fitted now"
assert abs(copied / first - 0.5) < 0.01, "a copy is not fitted any more"
PYTHON
