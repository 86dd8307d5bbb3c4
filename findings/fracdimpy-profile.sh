#!/usr/bin/env bash
# Guess: the estimators of fracDimPy, used as its readme shows, agree on the dimension of the
#   profile that its own generate_fbm_curve made, within their scatter; a profile is never below 1.
# Version: fracDimPy 0.1.5
# Behaviour: structural_function and variogram_method do. hurst_dimension and dfa sum up what they
#   are given, as if it were the slopes of a profile: a profile is summed twice. hurst_dimension is
#   1 for any roughness, dfa is one too low, below that of a line, with R^2 = 0.998.
# Output seen: D = 1.2, 1.5, 1.8: structural_function 1.20 1.50 1.81, variogram_method 1.21 1.51
#   1.81, hurst_dimension 0.99 1.00 1.02, dfa 0.20 0.50 0.83
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==2.2.6 scipy==1.15.3 \
    matplotlib==3.10.3 pillow==11.2.1 pandas==2.2.3 openpyxl==3.1.5
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps fracDimPy==0.1.5
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import fracDimPy
import numpy as np

estimators = {
    "structural_function": lambda profile: fracDimPy.structural_function(profile)[0],
    "variogram_method": lambda profile: fracDimPy.variogram_method(profile)[0],
    "hurst_dimension": lambda profile: fracDimPy.hurst_dimension(profile)[0],
    "dfa": lambda profile: fracDimPy.dfa(profile)[1]["dimension"],
}
wanted = np.array([1.2, 1.5, 1.8])
found = {}
for name, estimate in estimators.items():
    rows = [[estimate(fracDimPy.generate_fbm_curve(dimension, length=4096, seed=seed)[0])
             for seed in range(8)] for dimension in wanted]
    found[name] = np.mean(rows, axis=1)
    print(name, *(f"{value:.2f}" for value in found[name]))
quality = fracDimPy.dfa(fracDimPy.generate_fbm_curve(1.5, length=4096, seed=0)[0])[1]["r_squared"]
print(f"R^2 of dfa {quality:.3f}")
for name in ("structural_function", "variogram_method"):
    assert np.allclose(found[name], wanted, atol=0.03), "the structure function is wrong, too"
assert np.allclose(found["hurst_dimension"], 1, atol=0.05), "R/S has another dimension now"
assert np.allclose(found["dfa"], wanted - 1, atol=0.05), "DFA has another dimension now"
PYTHON
