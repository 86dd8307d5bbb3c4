#!/usr/bin/env bash
# Guess: range_x is the indentation, so (0, 300e-9) fits the first 300 nm after contact; where no
#   point is in contact, the fit says so.
# Version: nanite 4.2.3
# Behaviour: range_x is the tip position, negative in the sample. (0, 300e-9) is a piece of the
#   baseline; the start value of the modulus, 3000 Pa, comes back with success = True.
# Output seen: range (-3e-07, 0): E = 996.7 Pa, success True; range (0, 3e-07): E = 3000.0 Pa,
#   success True; true 1000 Pa
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check nanite==4.2.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from pathlib import Path

import numpy as np
from nanite import Indentation

stiffness, radius, modulus, n = 0.05, 5e-6, 1e3, 1000
tip = np.concatenate([np.linspace(2e-6, -5e-7, n), np.linspace(-5e-7, 2e-6, n)])
true = 4 / 3 * modulus / 0.75 * np.sqrt(radius) * np.maximum(-tip, 0) ** 1.5
noisy = true + 1e-12 * np.random.default_rng(1).normal(size=true.size)


def curve(force):
    return Indentation(
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


def fit(range_x):
    it = curve(noisy)
    it.apply_preprocessing(["compute_tip_position", "correct_force_offset", "correct_tip_offset"])
    parameters = it.get_initial_fit_parameters(model_key="hertz_para")
    parameters["R"].value = radius
    it.fit_model(
        model_key="hertz_para",
        params_initial=parameters,
        range_x=range_x,
        range_type="relative cp",
        weight_cp=0,
    )
    success = it.fit_properties["success"]
    fitted = it.fit_properties["params_fitted"]["E"].value
    print(f"range {range_x}: E = {fitted:.1f} Pa, success {success}")
    return fitted, success


assert abs(fit((-3e-7, 0))[0] / modulus - 1) < 0.02, "the negative range is not right any more"
assert fit((0, 3e-7)) == (3000.0, True), "a range without contact gives another answer"
PYTHON
