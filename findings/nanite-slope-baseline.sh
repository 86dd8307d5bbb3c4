#!/usr/bin/env bash
# Guess: correct_force_slope takes the slope of the baseline off the whole approach, so a linear
#   drift does not change the modulus.
# Version: nanite 4.2.3
# Behaviour: by default (region "baseline") only the rows before contact are levelled; the
#   indentation keeps its tilt. A curve with a straight baseline and a wrong modulus is the
#   result. region "approach" is right.
# Output seen: tilt of -0.3 pN/nm: not corrected 553 Pa, default 826 Pa, region approach 1000 Pa;
#   true 1000 Pa
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
tip = np.concatenate([np.linspace(2e-6, -5e-7, n), np.linspace(-5e-7, 2e-6, n)])
true = 4 / 3 * modulus / 0.75 * np.sqrt(radius) * np.maximum(-tip, 0) ** 1.5
tilted = true - 3e-4 * tip + 1e-12 * np.random.default_rng(1).normal(size=true.size)


def curve(force):
    return Indentation(
        {
            "force": force,
            "height (measured)": tip - force / stiffness,
            "segment": np.repeat([0, 1], n).astype(np.uint8),
            "time": np.linspace(0, 2, 2 * n),
        },
        {
            "path": Path("curve"),
            "enum": 0,
            "imaging mode": "force-distance",
            "spring constant": stiffness,
        },
    )


def fit(slope=None):
    it, steps = curve(tilted), ["compute_tip_position", "correct_tip_offset"]
    options = {"correct_tip_offset": {"method": "gradient_zero_crossing"}}
    if slope is not None:
        steps.append("correct_force_slope")
        options["correct_force_slope"] = slope
    it.apply_preprocessing([*steps, "correct_force_offset"], options=options)
    parameters = it.get_initial_fit_parameters(model_key="hertz_para")
    parameters["R"].value = radius
    it.fit_model(model_key="hertz_para", params_initial=parameters, weight_cp=0)
    return it.fit_properties["params_fitted"]["E"].value


plain, default, approach = fit(), fit({}), fit({"region": "approach"})
print(f"not corrected {plain:.0f} Pa, default {default:.0f} Pa, approach {approach:.0f} Pa")
assert abs(approach / modulus - 1) < 0.01, "region approach is not right any more"
assert default < 0.9 * modulus, "the default levels the indentation, too"
PYTHON
