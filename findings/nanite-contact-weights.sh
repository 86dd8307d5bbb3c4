#!/usr/bin/env bash
# Guess: weight_cp gives less weight to points near the contact, so it costs some precision, but
#   noise moves the modulus as often up as down.
# Version: nanite 4.2.3
# Behaviour: the weight is the distance from the fitted contact point, up to 1 um by default, on
#   the baseline, too. A contact point that moves into the noise makes the weighted sum of squares
#   smaller, so shallow noisy curves come out soft, one like another, and none is reported.
#   weight_cp=0 is free of it.
# Output seen: 200 nm deep, noise of 2 % of the largest force, 5 curves: default 773 to 822 Pa,
#   weight_cp=0 991 to 1029 Pa, default without noise 1000 Pa; true 1000 Pa
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

stiffness, radius, modulus, n = 0.05, 5e-6, 1e3, 2000
tip = np.concatenate([np.linspace(2e-6, -2e-7, n), np.linspace(-2e-7, 2e-6, n)])
true = 4 / 3 * modulus / 0.75 * np.sqrt(radius) * np.maximum(-tip, 0) ** 1.5


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


def fit(force, **options):
    it = curve(force)
    it.apply_preprocessing(["compute_tip_position", "correct_force_offset", "correct_tip_offset"])
    parameters = it.get_initial_fit_parameters(model_key="hertz_para")
    parameters["R"].value = radius
    it.fit_model(model_key="hertz_para", params_initial=parameters, **options)
    assert it.fit_properties["success"]
    return it.fit_properties["params_fitted"]["E"].value


noise = np.random.default_rng(1)
noisy = [true + 0.02 * true.max() * noise.normal(size=true.size) for _ in range(5)]
default, unweighted = [fit(f) for f in noisy], [fit(f, weight_cp=0) for f in noisy]
clean = fit(true)
print("default", np.round(default), "weight_cp=0", np.round(unweighted), "no noise", round(clean))
assert np.allclose(unweighted, modulus, rtol=0.03), "without weights noise moves the modulus, too"
assert abs(clean / modulus - 1) < 0.01, "the default is wrong without noise, too"
assert max(default) < 0.9 * modulus, "the default weight does not make noisy curves soft any more"
PYTHON
