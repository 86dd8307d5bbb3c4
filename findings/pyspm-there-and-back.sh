#!/usr/bin/env bash
# Guess: px2real of pySPM is the inverse of real2px; a point that goes to pixels and back is where
#   it was.
# Version: pySPM 0.6.3 (for Python 3.11 and 3.12)
# Behaviour: px2real counts pixels from the top and lengths from the bottom, real2px both from the
#   same end. y comes back as its mirror image in the middle of the scan; x is right.
# Output seen: (30, 20) um of 100 x 100 um comes back as 30, 80 um
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pySPM==0.6.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from pySPM import SPM_image

size = {"unit": "m", "x": 100e-6, "y": 100e-6}
image = SPM_image(np.zeros((100, 100)), real=size)
pixel = image.real2px(30, 20)
back = image.px2real(*pixel)
print("(30, 20) um is pixel", *pixel, f"and comes back as {back[0]:.0f}, {back[1]:.0f} um")
assert abs(back[0] - 30) < 1.5, "x does not come back, either"
assert abs(back[1] - 80) < 1.5, "y comes back in another way now"
PYTHON
