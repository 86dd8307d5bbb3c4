#!/usr/bin/env bash
# Guess: hertz_full of slippy gives two curved bodies the contact of one body with their relative
#   radii, which it returns, against a plane.
# Version: slippy 0.5.2 (for Python 3.11, with newer packages than the ones it asks for)
# Behaviour: with one body that is plane or round it does. With two that have two radii each, the
#   ellipse comes from the radii without a factor 2, that of 2 cos(2 angle), in the root: two
#   bodies whose relative radii are almost equal get a contact that is 1.33 times as long as wide,
#   where it is 1.08. Pressure and displacement are 1 % off.
# Output seen: radii 10, 20 and 10, 30 mm, crossed, relative 6.67 and 7.50 mm: 1.332 times as long
#   as wide; the same radii on a plane 1.082
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==1.26.4 scipy==1.11.4 numba==0.59.1 sympy==1.12 matplotlib==3.8.4 tinydb==4.8.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps slippy==0.5.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from slippy.contact import hertz_full

rubber = {"moduli": [1e6, 1e30], "v": [0.3, 0.3], "load": 1.0}


def compare(first, second, angle):
    pair = hertz_full(first, second, angle=angle, **rubber)
    radii = pair["relative_radii"]
    single = hertz_full(list(radii), float("inf"), **rubber)
    assert np.allclose(sorted(single["relative_radii"]), sorted(radii)), "other radii"
    shapes = [max(r) / min(r) for r in (pair["contact_radii"], single["contact_radii"])]
    print("relative radii {:.2f}, {:.2f} mm: ".format(*(1e3 * r for r in radii))
          + "{:.3f} times as long as wide, on a plane {:.3f}".format(*shapes))
    return shapes


round_one = compare([0.01, 0.02], [0.03, 0.03], 0.0)
crossed = compare([0.01, 0.02], [0.01, 0.03], np.pi / 2)
assert np.isclose(*round_one, rtol=1e-4), "beside a round body it is wrong, too"
assert crossed[1] < 1.1, "on a plane it is wrong, too"
assert crossed[0] > 1.3, "two bodies have the ellipse of their radii now"
PYTHON
