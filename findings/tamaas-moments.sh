#!/usr/bin/env bash
# Guess: the moments m0, m2, m4 of Statistics2D.computeMoments (tamaas) are those of Nayak: m2 is
#   the mean square slope of a profile, so the rms gradient is sqrt(2 m2), as
#   computeSpectralRMSSlope gives it.
# Version: tamaas 2.9.0 (its wheels are for Linux on x86-64)
# Behaviour: wave vectors are counted in waves per side, without 2 pi, in the moments, with it in
#   the slope; sqrt(2 m2) is 2 pi too small, m4 by (2 pi)^4, so a summit curvature by 39. Ratios
#   such as Nayak's alpha = m0 m4 / m2^2 hide it.
# Output seen: sqrt(2 m2) = 0.0283, rms slope 0.1777, ratio 6.283; true 0.1777
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check tamaas==2.9.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
import tamaas

waves, amplitude, n = 4, 0.01, 128  # on a square of side 1
wave = amplitude * np.cos(2 * np.pi * waves * np.arange(n) / n)
surface = np.ascontiguousarray(np.broadcast_to(wave, (n, n)))
m0, m2, m4 = tamaas.Statistics2D.computeMoments(surface)
slope = tamaas.Statistics2D.computeSpectralRMSSlope(surface)
true = amplitude * 2 * np.pi * waves / np.sqrt(2)
print(f"sqrt(2 m2) = {np.sqrt(2 * m2):.4f}, rms slope {slope:.4f}, true {true:.4f}, "
      f"ratio {slope / np.sqrt(2 * m2):.3f}")
assert np.isclose(m0, amplitude**2 / 2), "m0 is wrong, too"
assert np.isclose(slope, true), "the rms slope is wrong, too"
assert np.isclose(2 * m2, (slope / (2 * np.pi)) ** 2), "m2 has its 2 pi now"
assert np.isclose(m4, amplitude**2 / 2 * waves**4 / 3), "m4 is another one now"
PYTHON
