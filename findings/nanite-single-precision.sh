#!/usr/bin/env bash
# Guess: force and height in single precision, as Asylum Research stores them (.ibw), are fitted
#   like those in double precision.
# Version: nanite 4.2.3, afmformats 0.18.7
# Behaviour: the contact point that nanite guesses keeps the type of the column, numpy.float32,
#   for which its hash of a fit has no rule: ValueError, for every curve. The same numbers as
#   double precision are fitted.
# Output seen: float64: E = 1000 Pa; float32: ValueError: No rule to convert object '<class
#   'numpy.float32'>' to string.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    nanite==4.2.3 afmformats==0.18.7 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from pathlib import Path

import numpy as np
from nanite import Indentation

stiffness, radius, modulus, n = 0.05, 5e-6, 1e3, 1000
tip = np.concatenate([np.linspace(2e-6, -5e-7, n), np.linspace(-5e-7, 2e-6, n)])
true = 4 / 3 * modulus / 0.75 * np.sqrt(radius) * np.maximum(-tip, 0) ** 1.5


def fit(precision):
    curve = Indentation(
        {
            "force": true.astype(precision),
            "height (measured)": (tip - true / stiffness).astype(precision),
            "segment": np.repeat([0, 1], n).astype(np.uint8),
        },
        {
            "path": Path("curve"),
            "enum": 0,
            "imaging mode": "force-distance",
            "spring constant": stiffness,
        },
    )
    curve.apply_preprocessing(
        ["compute_tip_position", "correct_force_offset", "correct_tip_offset"]
    )
    parameters = curve.get_initial_fit_parameters(model_key="hertz_para")
    parameters["R"].value = radius
    curve.fit_model(model_key="hertz_para", params_initial=parameters)
    return curve.fit_properties["params_fitted"]["E"].value


double = fit(np.float64)
print(f"float64: E = {double:.0f} Pa")
assert abs(double / modulus - 1) < 0.01, "double precision is not right any more"
try:
    print(f"float32: E = {fit(np.float32):.0f} Pa")
except ValueError as error:
    print(f"float32: ValueError: {error}")
    assert "numpy.float32" in str(error), "another error"
else:
    raise SystemExit("single precision is fitted now")
PYTHON
