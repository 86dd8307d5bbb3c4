#!/usr/bin/env bash
# Guess: invertlaplace of mpmath with its default method, which its documentation calls as robust
#   as that of de Hoog, inverts what a ramp or step that ends adds to a load, exp(-s t0), or says
#   that it cannot.
# Version: mpmath 1.3.0
# Behaviour: the default is Cohen's method. It is exact to 15 digits for a relaxation, but after a
#   step it is 25 % low at 1.5 times, and still 1.6 % high at twice, the time of the step, without
#   a word. method="dehoog" is exact there; so is "talbot", which is 1e193 before the step.
# Output seen: relaxation exp(-t) at 1.5: 0.223130 (true 0.223130); unit step at 1, at 1.5: 0.749
#   (dehoog 1.000), at 2: 1.016 (1.000)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check mpmath==1.3.0
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import math

import mpmath


def step(s):
    return mpmath.exp(-s) / s


relaxed = float(mpmath.invertlaplace(lambda s: 1 / (s + 1), 1.5))
print(f"relaxation at 1.5: {relaxed:.6f} (true {math.exp(-1.5):.6f})")
default, dehoog = {}, {}
for time in (1.5, 2.0):
    default[time] = float(mpmath.invertlaplace(step, time))
    dehoog[time] = float(mpmath.invertlaplace(step, time, method="dehoog"))
    print(f"step at 1, at {time}: {default[time]:.3f}, dehoog {dehoog[time]:.3f}")
before = [abs(float(mpmath.invertlaplace(step, 0.5, method=name))) for name in ("cohen", "talbot")]
assert math.isclose(relaxed, math.exp(-1.5), rel_tol=1e-12), "a relaxation is wrong, too"
assert all(abs(value - 1) < 1e-6 for value in dehoog.values()), "dehoog is wrong, too"
assert abs(default[1.5] - 0.749) < 0.005, "the default at 1.5 is another one now"
assert 0.01 < default[2.0] - 1 < 0.02, "the default at 2 is another one now"
assert before[0] < 1e-6 and before[1] > 1e100, "before the step it is another one now"
PYTHON
