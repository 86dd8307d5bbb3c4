#!/usr/bin/env bash
# Guess: destripe of spym replaces the points of a scan stripe with the mean of the lines above and
#   below, as it says that it averages "neighbourhood lines".
# Version: spym 0.9.2 (with numpy 1.26 and SciPy 1.13)
# Behaviour: the mean is over three lines, that of the stripe among them, as the filter does not see
#   the mask. A third of each stripe stays; a second pass does not find it. The mask is right.
# Output seen: stripe of 3 nm on waves of 1 nm: 40 of 40 points found, 1.00 nm left, 0.67
#   nm after a second pass
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==1.26.4 scipy==1.13.1 xarray==2024.7.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps spym==0.9.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import importlib.util
from pathlib import Path

import numpy as np

# the package asks for programs that draw; its filters need none of them
place = Path(importlib.util.find_spec("spym").origin).parent / "process" / "filters.py"
spec = importlib.util.spec_from_file_location("filters", place)
filters = importlib.util.module_from_spec(spec)
spec.loader.exec_module(filters)

waves = np.sin(2 * np.pi * np.arange(64) / 32) * np.ones((64, 1))  # nm
scan = waves.copy()
scan[30, 10:50] += 3
once, mask = filters.destripe(scan.copy())
twice, _ = filters.destripe(once.copy())
left = [float((image - waves)[30, 10:50].mean()) for image in (once, twice)]
print(f"{int(mask.sum())} of 40 points found; {left[0]:.2f} nm left, {left[1]:.2f} after another")
assert mask.sum() == 40 and mask[30, 10:50].all(), "the stripe is found in another place"
assert np.allclose((once - waves)[~mask], 0), "other points are changed, too"
assert np.isclose(left[0], 1), "another part of the stripe is left now"
assert left[1] > 0.5, "a second pass takes more of it now"
PYTHON
