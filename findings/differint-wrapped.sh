#!/usr/bin/env bash
# Guess: GL of differint, the derivative of Grünwald and Letnikov "for an entire array", gives at
#   every time what GLpoint gives there, such as the stress of a springpot.
# Version: differint 1.0.0
# Behaviour: its convolution by Fourier transform is circular: what was there last comes before
#   the first. For a strain that grows as t^2 the stress begins at -8.6 where it ends at 1.5;
#   halfway it is still 28 % low. With an odd number of points there is one value fewer. GLpoint,
#   the sum for the last point alone, and RL are right.
# Output seen: order 0.5, 100 points from 0 to 1, at 0, 0.5 and 1: GL -8.63 0.39 1.50, RL 0.00 0.54
#   1.50, true 0.00 0.54 1.50; of 101 points 100 values
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check differint==1.0.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from math import gamma

import numpy as np
from differint.differint import GL, RL, GLpoint

time = np.linspace(0, 1, 100)
true = gamma(3) / gamma(2.5) * time**1.5


def square(t):
    return t**2


circular, direct = (np.array(rule(0.5, square, 0.0, 1.0, 100)) for rule in (GL, RL))
rows = [0, 50, 99]
for name, values in [("GL", circular), ("RL", direct), ("true", true)]:
    print(name, *(f"{value:.2f}" for value in values[rows]))
fewer = len(GL(0.5, square, 0.0, 1.0, 101))
print(f"of 101 points {fewer} values")
last = GLpoint(0.5, square, 0.0, 1.0, 100)
assert np.allclose(direct, true, atol=1e-3), "RL is wrong, too"
assert np.isclose(last, true[-1], rtol=0.01), "GLpoint is wrong, too"
assert circular[0] < -5, "the first value does not see the last one any more"
assert circular[50] < 0.75 * true[50], "halfway it is right now"
assert fewer == 100, "an odd number of points keeps its number now"
PYTHON
