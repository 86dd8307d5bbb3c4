#!/usr/bin/env bash
# Guess: get_fit_all of pyrtz2 gives the same moduli when it is called once more with the same range
#   of indentation, and the right ones with another range.
# Version: pyrtz2 1.4.8
# Behaviour: each call shifts each curve to its contact point, by the values that the point had
#   before the first shift, which are kept. From the second call on the curves are shifted once too
#   often: the indentation does not begin at 0 any more, and Hertz's law is fitted to that (or
#   raises an error, where it begins below 0).
# Output seen: the same curve and range: first fit 1.000 of the modulus, second fit 0.335
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==2.2.6 scipy==1.15.3 \
    pandas==2.2.3 scikit-learn==1.5.2 PyPDF2==3.0.1 tqdm==4.67.1 dash==3.1.1 plotly==6.3.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps pyrtz2==1.4.8
cd "$folder"
TQDM_DISABLE=1 "$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
import pandas as pd
from pyrtz2.curves import Curve, CurveSet

radius, modulus, stiffness, rate, hold = 5e-6, 1000.0, 0.03, 1000.0, 1.0
touch, deepest = 1e-6, 1e-6  # m
indentation = np.concatenate([np.linspace(-touch, deepest, 1001), np.full(1000, deepest)])
time = np.arange(len(indentation)) / rate
force = 4 / 3 * modulus * np.sqrt(radius) * np.maximum(indentation, 0) ** 1.5
after = np.maximum(time - time[1000], 0)
force[1000:] *= 0.6 + 0.3 * np.exp(-after[1000:] / 0.05) + 0.1 * np.exp(-after[1000:] / 0.5)
deflection = force / stiffness
start = -7e-7  # of the sensor where the bead touches
ramp = indentation + start + deflection
data = pd.DataFrame({"rawz": ramp, "z": ramp, "defl": deflection, "ind": ramp - deflection,
                     "t": time, "f": force})
curve = Curve("curve.ibw", data, {"DwellTime": str(hold)}, 1e-8, stiffness, [1000, 2000])
curves = CurveSet(["spot"], {("1",): curve})
curves.update_annotations({("1",): 500})  # the contact point

seen = []
for call in ("first", "second"):
    table = curves.get_fit_all(2 * radius, [0.0, 1.0])
    seen.append((float(table["Hertzian_E"][0]) / modulus, float(table["Hertzian_R2"][0])))
    print(f"{call} fit: {seen[-1][0]:.3f} of the modulus, R^2 {seen[-1][1]:.3f}")
assert np.isclose(seen[0][0], 1, rtol=1e-3), "the first fit is wrong, too"
assert np.isclose(seen[1][0], 0.335, rtol=0.01), "the second fit has another modulus now"
PYTHON
