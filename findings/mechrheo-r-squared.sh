#!/usr/bin/env bash
# Guess: the R squared that mechrheo prints for a fit of viscosities, Cross-WLF, is at most 1 and
#   near 1 for a good model.
# Version: mechrheo 0.1.0
# Behaviour: it is the scatter of the data over the scatter of the model. A model of half the
#   viscosity has 1.58, one of twice the viscosity 0.61, where 1 - residuals over scatter are 0.92
#   and 0.89. A model that is far too low gets an arbitrarily large one; any that scatters as the
#   data do has 1, right or not.
# Output seen: true model 1.00; half the viscosity 1.58 (0.92); twice 0.61 (0.89); temperatures
#   turned round 1.00 (0.51)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    mechrheo==0.1.0 Pint==0.25.3 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from mechrheo.fitdata import FitData
from mechrheo.models import CrossWLF

kelvin, rates = np.array([460.0, 480.0, 500.0]), np.geomspace(10, 1e4, 10)


def model(factor):
    melt = CrossWLF()
    melt.tau_star, melt.A_1, melt.A_2, melt.D_1 = 2e4, 25.0, 51.6, factor * 1e12
    melt.D_2, melt.n = 370.0, 0.3
    return melt


points = np.meshgrid(kelvin, rates)
viscosity = model(1.0)(points)
rows = [[0.0, *kelvin], *np.column_stack([rates, viscosity]).tolist()]
with open("melt.csv", "w") as file:
    file.write("# row: frequency Hz\n# column: temperature K\n# data: viscosity Pa*s\n")
    file.writelines(",".join(map(repr, map(float, row))) + "\n" for row in rows)
data = FitData(filename="melt.csv")


def compare(name, other, at):
    found = float(data.calc_r_squared(other, at))
    right = 1 - np.sum((viscosity - other(at)) ** 2) / np.sum((viscosity - viscosity.mean()) ** 2)
    print(f"{name}: {found:.2f} ({right:.2f})")
    return found, right


true = compare("true model", model(1.0), points)
half = compare("half the viscosity", model(0.5), points)
twice = compare("twice the viscosity", model(2.0), points)
turned = compare("temperatures turned round", model(1.0), np.meshgrid(kelvin[::-1], rates))
assert np.allclose(true, 1), "the true model has another one"
assert half[0] > 1.5 and 0.9 < half[1] < 1, "half the viscosity is below 1 now"
assert twice[0] < 0.65, "twice the viscosity has another one now"
assert np.isclose(turned[0], 1) and turned[1] < 0.9, "a wrong model is told from a right one now"
PYTHON
