#!/usr/bin/env bash
# Guess: each coefficient of a hyperelastic model of hypermat enters its stress: C30 that of Yeoh
#   (sum of Ci0 (I1 - 3)^i), C20 and C01 that of Isihara (a sum of three terms).
# Version: hypermat 0.1.2
# Behaviour: Yeoh leaves out its last coefficient, which it takes for the bulk modulus that has been
#   taken out before: with three it is the model of two, with two it is neo-Hooke. Isihara
#   multiplies its last two terms: with C20 or C01 alone it is neo-Hooke.
# Output seen: stretch 1.5, tension over the closed form: Yeoh with 2, 3 coefficients 0.63 0.89,
#   Isihara with C20 0.63, with C01 0.75; Mooney-Rivlin 1.00
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==1.26.4 scipy==1.11.4 \
    matplotlib==3.8.4 lmfit==1.3.2 tensortrax==0.29.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps hypermat==0.1.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import hypermat
import numpy as np

stretch = 1.5
across = stretch**-0.5
gradient = np.diag([stretch, across, across])[:, :, None, None]
above = stretch**2 + 2 / stretch - 3  # the first invariant less 3


def pull(model):
    """Return the force per undeformed area of an incompressible bar."""
    stress = np.asarray(model.jacobian(gradient)) * np.ones((3, 3, 1, 1))
    return float(stress[0, 0, 0, 0] - stress[2, 2, 0, 0] * across / stretch)


def share(model, first, second=0.0):
    """Compare with the derivatives of the energy by the two invariants."""
    true = 2 * (stretch - stretch**-2) * (first + second / stretch)
    found = pull(model) / true
    print(f"{model._label} {model.kwargs}: {found:.2f} of the closed form")
    return found


mooney = share(hypermat.MooneyRivlin(C10=1.0, C01=0.5), 1.0, 0.5)
two = share(hypermat.Yeoh(C10=1.0, C20=0.5), 1 + 2 * 0.5 * above)
three = share(hypermat.Yeoh(C10=1.0, C20=0.5, C30=0.2), 1 + above + 3 * 0.2 * above**2)
square = share(hypermat.Isihara(C10=1.0, C20=0.5, C01=0.0), 1 + above)
second = share(hypermat.Isihara(C10=1.0, C20=0.0, C01=0.5), 1.0, 0.5)
assert np.isclose(mooney, 1), "Mooney-Rivlin is wrong, too"
assert np.allclose([two, three], [0.632, 0.886], atol=1e-3), "Yeoh has another stress now"
assert np.allclose([square, second], [0.632, 0.75], atol=1e-3), "Isihara has another stress now"
PYTHON
