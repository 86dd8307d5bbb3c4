#!/usr/bin/env bash
# Guess: generate_takagi_curve of fracDimPy makes a bounded profile of the dimension asked for with
#   any base b > 1 that it accepts, the more exact the more levels it has.
# Version: fracDimPy 0.1.5
# Behaviour: the amplitude of a level is b^D / 4 of that before, which is b^(D - 2) for the base 2
#   only. For another base the dimension is another one; from b = 4^(1/D) on each level is higher
#   than the one before and the profile grows without end.
# Output seen: D = 1.5, range of the heights for 5, 10, 15 levels: base 2: 0.97 1.11 1.13; base 3:
#   4.4 17.8 67.7; base 4: 13 439 14048
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==2.2.6 scipy==1.15.3 \
    matplotlib==3.10.3 pillow==11.2.1 pandas==2.2.3 openpyxl==3.1.5
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps fracDimPy==0.1.5
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import fracDimPy
import numpy as np

dimension, levels = 1.5, (5, 10, 15)
ranges, found = {}, {}
for base in (2.0, 3.0, 4.0):
    profiles = [fracDimPy.generate_takagi_curve(dimension, level=count, length=4096, b=base)[1]
                for count in levels]
    ranges[base] = [float(np.ptp(profile)) for profile in profiles]
    found[base] = fracDimPy.structural_function(profiles[1])[0]
    print(f"base {base:.0f}: range", *(f"{value:.3g}" for value in ranges[base]),
          f"for {levels} levels; dimension {found[base]:.2f}")
assert abs(found[2.0] - dimension) < 0.05, "the base 2 is wrong, too"
assert ranges[2.0][2] < 1.2, "the base 2 grows, too"
assert np.isclose(ranges[3.0][2], 67.7, rtol=0.01), "the base 3 has another range now"
assert ranges[4.0][2] > 1e4, "the base 4 does not grow any more"
PYTHON
