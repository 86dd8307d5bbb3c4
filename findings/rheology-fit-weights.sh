#!/usr/bin/env bash
# Guess: the column shear_stress_std of a flow curve, which rheology-fit reads and checks, weights
#   its fit; a point with a standard deviation of 1000 Pa counts for nothing.
# Version: rheology-fit 0.1.0
# Behaviour: it is drawn as error bars. The fit, its errors, R squared and the choice of the best
#   model treat all points alike: one point that was marked as worthless makes a fluid of index 0.5
#   one of 0.23.
# Output seen: index n: without the bad point 0.500, with it at 1000 Pa 0.233, at 0.01 Pa 0.233
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.0.1
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps rheology-fit==0.1.0
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from pathlib import Path

import numpy as np
from rheology_fit.data import load_flow_curve_csv
from rheology_fit.models import fit_model


def fit(rates, stresses, deviations):
    rows = [f"{r},{s},{d}" for r, s, d in zip(rates, stresses, deviations)]
    Path("flow.csv").write_text("\n".join(["shear_rate,shear_stress,shear_stress_std", *rows]))
    data = load_flow_curve_csv("flow.csv")
    assert np.allclose(data.shear_stress_std, deviations), "the column is not read"
    return fit_model(data, "PowerLaw").params["n"]


rates = np.geomspace(1, 100, 9)
stresses, deviations = 5 * rates**0.5, np.full(9, 0.1)
clean = fit(rates[:-1], stresses[:-1], deviations[:-1])
stresses[-1] *= 0.2  # slipped
bad = []
for deviation in (1000.0, 0.01):
    deviations[-1] = deviation
    bad.append(fit(rates, stresses, deviations))
print(f"index n: without the bad point {clean:.3f}, with it at 1000 Pa {bad[0]:.3f}, "
      f"at 0.01 Pa {bad[1]:.3f}")
assert np.isclose(clean, 0.5, atol=1e-3), "without the point it is wrong, too"
assert bad[0] < 0.3, "the point counts for less now"
assert np.isclose(*bad), "the deviation weights the fit now"
PYTHON
