#!/usr/bin/env bash
# Guess: the Reynolds number of lubepy for a duct of rectangular section is that of the hydraulic
#   diameter, 2 a b / (a + b), with the speed that the flow rate has in that section.
# Version: lubepy 1.0a0
# Behaviour: the diameter is, the speed is that in a round pipe of that diameter. A square duct has
#   a number 27 % too high, a flat one of 20 mm by 2 mm one of 3.9 times the true one; so laminar
#   flow in a gap is called mixed or turbulent. A round pipe is right.
# Output seen: found over true: round 1.00, square 1.27, 20 x 2 mm 3.85; flow in the latter at
#   Re 1263: turbulent
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check lubepy==1.0a0
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from math import isclose, pi

from lubepy.fluid.reynolds import (
    flow_type_rectangular_session,
    reynolds_circular_session,
    reynolds_rectangular_session,
    reynolds_square_session,
)

oil = (100.0, 11.2, 40.0)  # cSt at 40 and 100 degC; temperature, so 100 cSt
flow, side, base, height = 5000.0, 10.0, 20.0, 2.0  # l/h, mm
litres, viscosity = flow * 1e-3 / 3600, 100e-6  # m^3/s, m^2/s
true = [
    4 * litres / (pi * side * 1e-3 * viscosity),
    litres / (side * 1e-3 * viscosity),
    2 * litres / ((base + height) * 1e-3 * viscosity),
]
found = [
    reynolds_circular_session(flow, *oil, side),
    reynolds_square_session(flow, *oil, side),
    reynolds_rectangular_session(flow, *oil, base, height),
]
kind = flow_type_rectangular_session(flow, *oil, base, height).value
shares = [one / other for one, other in zip(found, true)]
print("found over true: round {:.2f}, square {:.2f}, 20 x 2 mm {:.2f}; ".format(*shares)
      + f"flow at Re {true[2]:.0f}: {kind}")
assert isclose(shares[0], 1, rel_tol=0.01), "a round pipe is wrong, too"
assert isclose(shares[1], 4 / pi, rel_tol=0.01), "a square duct has another number now"
assert isclose(shares[2], 4 / pi * (base + height) ** 2 / (4 * base * height), rel_tol=0.01), (
    "a flat duct has another number now"
)
assert true[2] < 2100 and kind == "turbulent", "the flow is called something else now"
PYTHON
