#!/usr/bin/env bash
# Guess: SystemFODEs of numfracpy, which has the predictor and corrector of FODE, is as accurate for
#   coupled equations as FODE is for one.
# Version: numfracpy 0.4
# Behaviour: the predicted values are set to zero again before each equation, so the corrector sees
#   a prediction of the last equation only, and zero for all others. The error falls with the step,
#   not with its square, and is a thousand times larger than FODE's; the order of the equations
#   matters.
# Output seen: oscillation at 2, step 0.01: off by 6.6e-03, half the step 3.3e-03; one equation:
#   4.5e-06 and 1.1e-06
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numfracpy==0.4 numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from math import cos, exp, sin

import numfracpy


def oscillate(step):
    equations = [lambda state: state[2], lambda state: -state[1]]
    _, (place, speed) = numfracpy.SystemFODEs(equations, [1.0, 0.0], [0.0, 2.0], step, [1.0, 1.0])
    return max(abs(float(place[-1]) - cos(2)), abs(float(speed[-1]) + sin(2)))


def decay(step):
    _, values = numfracpy.FODE(lambda t, u: -u, [1.0], [0.0, 2.0], step, 1.0)
    return abs(float(values[-1]) - exp(-2))


system, single = [oscillate(step) for step in (0.01, 0.005)], [decay(s) for s in (0.01, 0.005)]
print("two equations: off by {:.1e}, half the step {:.1e}".format(*system))
print("one equation: off by {:.1e}, half the step {:.1e}".format(*single))
assert single[0] < 1e-5 and single[0] / single[1] > 3.5, "one equation is inaccurate, too"
assert system[0] > 500 * single[0], "the system is as accurate now"
assert 1.8 < system[0] / system[1] < 2.2, "the error falls faster than the step now"
PYTHON
