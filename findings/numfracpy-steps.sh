#!/usr/bin/env bash
# Guess: FODE of numfracpy solves from 0 to 0.3 with a step of 0.1 in three steps, and Caputo_der1
#   differentiates at the time it is given.
# Version: numfracpy 0.4
# Behaviour: the number of steps is the quotient cut to an integer, and 0.3 / 0.1 is less than 3 in
#   floating point. FODE then spreads two steps over the whole interval but solves with 0.1: the
#   relaxation at 0.3 is the one at 0.2. Caputo_der1 at 0.29 with 0.01 is the derivative at 0.28,
#   5 % low. Which ends and steps are hit looks like chance (0.3 by 0.01 is not).
# Output seen: relaxation of order 0.9 at 0.3: 0.786, three steps 0.708, true 0.708; derivative of
#   t^2 at 0.28 0.222, at 0.29 0.222, true at 0.29 0.235
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numfracpy==0.4 numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from math import gamma, isclose

import numfracpy


def relax(step):
    times, values = numfracpy.FODE(lambda t, u: -u, [1.0], [0.0, 0.3], step, 0.9)
    return times[-1], values[-1]


def differentiate(time):
    return float(numfracpy.Caputo_der1(lambda t: t**2, time, 0.01, 0.5))


end, found = relax(0.1)
_, three = relax(0.3 / 3.000001)
true = float(numfracpy.Mittag_Leffler_one(-(0.3**0.9), 0.9))
print(f"relaxation at {end:.1f}: {found:.3f}, three steps {three:.3f}, true {true:.3f}")
slope = gamma(3) / gamma(2.5) * 0.29**1.5
before, at = differentiate(0.28 + 1e-6), differentiate(0.29)
print(f"derivative: at 0.28 {before:.3f}, at 0.29 {at:.3f}, true at 0.29 {slope:.3f}")
assert isclose(three, true, rel_tol=0.01), "three steps are wrong, too"
assert isclose(differentiate(0.29 + 1e-6), slope, rel_tol=0.01), "the derivative is wrong, too"
assert end == 0.3 and found > 1.1 * true, "0.3 by 0.1 are three steps now"
assert isclose(at, before), "0.29 by 0.01 are 29 steps now"
PYTHON
