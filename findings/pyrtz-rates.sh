#!/usr/bin/env bash
# Guess: tau1, tau2 and tau0 of pyrtz, "biexponential" and "exponential decay" of the force in a
#   dwell, are times, tau_fast the shorter one.
# Version: pyrtz 0.1.8 (without its dependencies that are part of dash today)
# Behaviour: they are rates, exp(-t tau) is fitted: 2 per second for a time of 0.5 s. tau_fast is
#   the larger number. The table of results and its columns (and those of pyrtz2, dwell_tauMax and
#   dwell_tauMin) have the names of times and no unit. A time and its rate are easily mistaken where
#   they are near 1 s.
# Output seen: relaxation within 0.5 s and 5 s: tau_fast 2.000, tau_slow 0.200
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 plotly==7.1.0 dash==4.4.1 PyPDF2==3.0.1 igor2==0.5.15
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps pyrtz==0.1.8
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
import pandas as pd
from pyrtz.curves import Curve

rows, times, weights = 2001, (0.5, 5.0), (0.6, 0.4)
time = np.linspace(0, 20, rows)
force = 1 + sum(weight * np.exp(-time / tau) for weight, tau in zip(weights, times))  # nN
nothing = np.zeros(rows)
data = pd.DataFrame({"z": nothing, "t": time, "f": force, "ind": nothing})
curve = Curve("dwell", data, {}, "z", "t", "f", "ind", 1.0, 1.0, [0, rows - 1])
curve.fit_biexponential()
fast, slow = (float(curve.biexponential_fit[name]) for name in ("tau_fast", "tau_slow"))
print(f"relaxation within {times[0]} s and {times[1]} s: tau_fast {fast:.3f}, tau_slow {slow:.3f}")
assert np.isclose(curve.biexponential_fit["A"], weights[0], rtol=1e-3), "the fit is wrong, too"
assert np.allclose([fast, slow], [1 / tau for tau in times], rtol=1e-3), "they are times now"
PYTHON
