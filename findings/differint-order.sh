#!/usr/bin/env bash
# Guess: the first argument of GLI in differint, the "improved" rule of Grünwald and Letnikov, is
#   the order of the derivative, as in GL and RL.
# Version: differint 1.0.0
# Behaviour: the order scales with the step only; the coefficients are those of 0.5. At 0.5 it is
#   right, though less so than RL; at 0.2 it is 31 % of the true one with 100 points and less with
#   more points; the integral of order -0.5 is 2 % of the true one.
# Output seen: t^2 at 1, GLI and RL over true: order 0.5: 0.97 1.00; order 0.2: 0.31 1.00; order
#   -0.5: 0.02 1.00
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check differint==1.0.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from math import gamma

import numpy as np
from differint.differint import GLI, RL


def compare(order, points=100):
    true = gamma(3) / gamma(3 - order)
    return [float(rule(order, lambda t: t**2, 0.0, 1.0, points)[-1] / true) for rule in (GLI, RL)]


seen = {order: compare(order) for order in (0.5, 0.2, -0.5)}
for order, (improved, plain) in seen.items():
    print(f"order {order}: GLI {improved:.2f}, RL {plain:.2f} of the true one")
assert np.allclose([plain for _, plain in seen.values()], 1, atol=0.01), "RL is wrong, too"
assert abs(seen[0.5][0] - 1) < 0.05, "order 0.5 is wrong, too"
assert seen[0.2][0] < 0.4, "order 0.2 is not that of 0.5 any more"
assert compare(0.2, 1000)[0] < 0.6 * seen[0.2][0], "more points do not make it worse any more"
assert abs(seen[-0.5][0]) < 0.05, "order -0.5 is not that of 0.5 any more"
PYTHON
