#!/usr/bin/env bash
# Guess: a point without a height in a binary .sdf (ISO 25178-71) of doubles is a missing point
#   for whoever reads it, as it is in integers.
# Version: surfalize 0.19.2 (writes), SurfaceTopography 1.27.1 (reads)
# Behaviour: surfalize writes the least double for it and reads it back as missing.
#   SurfaceTopography knows markers of integers and NaN only: the point is a height of minus
#   infinity (the least double in micrometres), has_undefined_data is False and the mean height is
#   minus infinity.
# Output seen: surfalize: 1 missing; SurfaceTopography: has_undefined_data False, lowest -inf,
#   mean -inf
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    surfalize==0.19.2 SurfaceTopography==1.27.1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import warnings

import numpy as np
from SurfaceTopography import read_topography
from surfalize import Surface

warnings.simplefilter("ignore")
row, column = np.mgrid[:4, :4]
heights = 10.0 * row + column
heights[1, 2] = np.nan
Surface(heights, 1.0, 1.0).save("scan.sdf")

again = Surface.load("scan.sdf").data
print("surfalize:", np.isnan(again).sum(), "missing")
assert np.isnan(again[1, 2]) and np.isnan(again).sum() == 1, "surfalize reads another surface"
topography = read_topography("scan.sdf")
read = topography.heights()
marked = topography.has_undefined_data
print(f"has_undefined_data {marked}, lowest {read.min()}, mean {read.mean()}")
assert not marked, "the missing point is recognised now"
assert read[2, 1] < -1e300 and not np.isfinite(read.mean()), "the marker is another height now"
valid = np.isfinite(heights)
assert np.allclose(read.T[valid], heights[valid]), "the other points are wrong, too"
PYTHON
