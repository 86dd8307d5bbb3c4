#!/usr/bin/env bash
# Guess: one array, saved as text and as .npy and read with the same physical_sizes, is one
#   surface.
# Version: SurfaceTopography 1.27.1
# Behaviour: in text, columns run along x; in .npy (and .mat), rows do. The second surface is the
#   first one transposed, and each size belongs to the other direction: of a scan 60 um wide and
#   20 um high, slopes along one axis are three times too large, along the other a third.
# Output seen: text: (6, 4) points, slopes 0.10 along x and 0 along y; .npy: (4, 6) points, 0 and
#   0.30
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    SurfaceTopography==1.27.1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from SurfaceTopography import read_topography

ramp = np.tile(np.arange(6.0), (4, 1))  # rises by 1 um a column; 4 rows, 6 columns
np.savetxt("scan.txt", ramp)
np.save("scan.npy", ramp)
slopes = {}
for name in ("scan.txt", "scan.npy"):
    topography = read_topography(name, physical_sizes=(60, 20), unit="µm")
    along_x, along_y = topography.derivative(1)
    slopes[name] = abs(along_x).max(), abs(along_y).max()
    print(name, topography.nb_grid_pts, "slopes {:.2f} and {:.2f}".format(*slopes[name]))
assert np.allclose(slopes["scan.txt"], (0.1, 0)), "text is read in another way now"
assert np.allclose(slopes["scan.npy"], (0, 0.3)), ".npy is read in another way now"
PYTHON
