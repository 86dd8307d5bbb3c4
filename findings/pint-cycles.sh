#!/usr/bin/env bash
# Guess: pint, which knows hertz, turns and radians, converts the frequency of an oscillation to
#   the angular frequency that a modulus is given at: 1 Hz is 2 pi rad/s, 60 rpm are 1 Hz.
# Version: Pint 0.25.3
# Behaviour: a hertz is one over a second and a radian is one, so 1 Hz is 1 rad/s and 10 rad/s are
#   10 Hz; a turn is 2 pi, so 60 rpm are 6.28 Hz. Only turns/s to rad/s is what a rheologist
#   expects. The moduli of a table in Hz land 2 pi too low on the frequency axis.
# Output seen: 1 Hz = 1.000 rad/s; 10 rad/s = 10.000 Hz; 60 rpm = 6.283 Hz; 1 turn/s = 6.283 rad/s
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check Pint==0.25.3
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from math import isclose, pi

import pint

units = pint.UnitRegistry()
cases = [(1, "Hz", "rad/s"), (10, "rad/s", "Hz"), (60, "rpm", "Hz"), (1, "turn/s", "rad/s")]
found = [units.Quantity(value, before).m_as(after) for value, before, after in cases]
for (value, before, after), converted in zip(cases, found):
    print(f"{value} {before} = {converted:.3f} {after}")
assert isclose(found[3], 2 * pi), "turns per second are wrong, too"
assert isclose(found[0], 1) and isclose(found[1], 10), "hertz to radians has 2 pi now"
assert isclose(found[2], 2 * pi), "turns per minute to hertz are another number now"
PYTHON
