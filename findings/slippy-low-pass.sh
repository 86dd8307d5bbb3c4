#!/usr/bin/env bash
# Guess: low_pass_filter of slippy leaves what is longer than its limit as it is: a level surface,
#   and a wave ten times as long.
# Version: slippy 0.5.2 (for Python 3.11, with newer packages than the ones it asks for)
# Behaviour: the filter's points are those of one quadrant, begin beside its middle and are not
#   scaled to a sum of one. With a limit of 0.1 per point a level of 1 becomes 0.17 in the middle;
#   with a higher limit, which should change less, 0.05; and it differs from place to place.
#   Summits that are found after filtering are those of what is left.
# Output seen: limit 0.1: level 0.165, near a corner 0.012, wave 0.118; limit 0.25: level 0.047
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
from slippy.surface.roughness_funcs import low_pass_filter

points = 64
level = np.ones((points, points))
wave = np.tile(np.sin(2 * np.pi * np.arange(points) / 100), (points, 1))


def keep(heights, limit):
    return np.asarray(low_pass_filter(heights, limit, 1.0))


found, finer = keep(level, 0.1), keep(level, 0.25)
middle = slice(points // 2 - 8, points // 2 + 8)
share = np.abs(keep(wave, 0.1)[middle, middle]).max() / np.abs(wave[middle, middle]).max()
print(f"limit 0.1: level {found[32, 32]:.3f}, near a corner {found[10, 50]:.3f}, wave {share:.3f}; "
      f"limit 0.25: level {finer[32, 32]:.3f}")
assert 0.1 < found[32, 32] < 0.25, "a level surface keeps its height now"
assert finer[32, 32] < 0.1, "with a higher limit it keeps more now"
assert abs(found[10, 50]) < 0.05, "a level surface stays level now"
assert share < 0.3, "a long wave passes now"
PYTHON
