#!/usr/bin/env bash
# Guess: slice_3d of AFMSlicer, which takes "the appropriate number of slices" from the range of the
#   heights and the scaling, finds a slice for each pixel.
# Version: afmslicer 0.0.1 (without TopoStats, which this module does not use)
# Behaviour: the range is rounded up to a whole number before it is divided by the thickness, and
#   the quotient is cut off. Too few slices, and all that is above the last one is in none, except
#   the very highest pixel; or slices above the surface.
# Output seen: heights 10.0 to 13.9, thickness 1.5: 2 slices, 3 of 8 pixels in none; heights 10.0 to
#   14.0, thickness 1.0: 4 slices, 0 in none; heights 10.0 to 10.2, thickness 0.1: 10 slices
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==2.2.6 scipy==1.15.3 \
    scikit-image==0.25.2 loguru==0.7.3 pandas==2.2.3 snoop==0.6.0 packaging==24.2
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps afmslicer==0.0.1
cd "$folder"
LOGURU_LEVEL=ERROR "$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from afmslicer import slicer


def cut(span, thickness):
    heights = 10 + span * np.array([[0.0, 0.2, 0.4, 0.6], [0.79, 0.82, 0.9, 0.97]])
    heights[-1, -1] = 10 + span
    slices = slicer.slice_3d(heights, thickness)
    lost = int(np.sum(~np.any(slices != 0, axis=0)))
    print(f"heights 10.0 to {heights.max():.1f}, thickness {thickness}: {len(slices)} slices, "
          f"{lost} of {heights.size} pixels in none")
    return len(slices), lost


assert cut(4.0, 1.0) == (4, 0), "a whole number of slices is wrong, too"
assert cut(3.9, 1.5) == (2, 3), "the range of 3.9 is cut in another way now"
assert cut(0.2, 0.1)[0] == 10, "the range of 0.2 has another number of slices now"
PYTHON
