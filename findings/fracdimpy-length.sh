#!/usr/bin/env bash
# Guess: generate_fbm_curve of fracDimPy makes a fractional Brownian profile of the dimension asked
#   for, whatever its length: neighbouring increments have the correlation 2^(2H-1) - 1, H = 2 - D.
# Version: fracDimPy 0.1.5
# Behaviour: the spectrum is that of twice the length, the noise it shapes has the next power of
#   two. Where that is much longer, the spectrum runs to its end and back within it: the slopes are
#   as strong at the shortest wavelengths as at the longest, and increments are uncorrelated.
# Output seen: D = 1.2, correlation of neighbouring increments (0.516 expected): 1024 points 0.49,
#   1025 points 0.02, 2048 points 0.50, 2049 points 0.01
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

dimension = 1.2
expected = 2 ** (2 * (2 - dimension) - 1) - 1
found = {}
for length in (1024, 1025, 2048, 2049):
    shares = []
    for seed in range(20):
        profile, _ = fracDimPy.generate_fbm_curve(dimension, length=length, seed=seed)
        steps = np.diff(profile)
        shares.append(np.corrcoef(steps[1:], steps[:-1])[0, 1])
    found[length] = np.mean(shares)
    print(f"{length} points: correlation of neighbouring increments {found[length]:.2f}")
print(f"expected: {expected:.3f}")
for length in (1024, 2048):
    assert abs(found[length] - expected) < 0.06, "a power of two is wrong, too"
for length in (1025, 2049):
    assert abs(found[length]) < 0.06, "another length has another correlation now"
PYTHON
