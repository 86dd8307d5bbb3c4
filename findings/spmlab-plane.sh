#!/usr/bin/env bash
# Guess: plane() of spmlab (and of spym, whose copy it is) takes a plane off an image: what is left
#   has a mean of zero, and with the background that is returned makes the image.
# Version: spmlab 0.1.5
# Behaviour: the background is the sum of a line fitted along x and one along y, and both have the
#   mean height. It is taken off twice: an image around 100 nm is one around -100 nm afterwards.
#   The slopes are right. The sum with the background makes the image, so that does not show it.
# Output seen: mean 100.5 nm before, -100.5 nm after; rms 0.0 nm
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==2.4.6 scipy==1.17.1 \
    xarray==2026.9.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps spmlab==0.1.5
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from spmlab.readers.spym.process.level import plane

y, x = np.mgrid[:20, :30]
image = 100 + 2.0 * x - 3.0 * y
left, background = plane(image)
print(f"mean {image.mean():.1f} nm before, {left.mean():.1f} nm after; rms {left.std():.1f} nm")
assert np.allclose(left + background, image), "image and background do not fit, too"
assert np.isclose(left.std(), 0, atol=1e-9), "the slopes are wrong, too"
assert np.isclose(left.mean(), -image.mean()), "the mean is taken off once now"
PYTHON
