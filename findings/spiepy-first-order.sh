#!/usr/bin/env bash
# Guess: flatten_poly_xy of SPIEPy with deg=1, a "polynomial plane fit" of first order, takes a
#   plane off; a twist x y, as of a warped sample, stays.
# Version: SPIEPy 0.2.1
# Behaviour: the order is that of each coordinate: order 1 is a + b x + c y + d x y, order 2 goes
#   up to x^2 y^2. A saddle comes back flat, its heights and slopes gone. flatten_xy, also
#   "first order", takes a plane only, so the two differ.
# Output seen: saddle of 0.336 um rms with a tilt: flatten_xy 0.336, flatten_poly_xy 0.000 um
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check SPIEPy==0.2.1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
import spiepy

x, y = np.meshgrid(np.linspace(-1, 1, 256), np.linspace(-1, 1, 256))
saddle = x * y
image = saddle + 0.3 * x - 0.2 * y
plane, _ = spiepy.flatten_xy(image)
first, _ = spiepy.flatten_poly_xy(image, deg=1)
second, _ = spiepy.flatten_poly_xy(image + x**2 * y**2, deg=2)
print(f"saddle {saddle.std():.3f} um rms: flatten_xy {plane.std():.3f}, "
      f"flatten_poly_xy {first.std():.3f}; x^2 y^2, deg=2: {second.std():.3f} um")
assert np.isclose(plane.std(), saddle.std(), rtol=0.01), "flatten_xy takes the saddle off, too"
assert first.std() < 1e-9, "the saddle stays now"
assert second.std() < 1e-6, "x^2 y^2 stays now"
PYTHON
