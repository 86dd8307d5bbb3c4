#!/usr/bin/env bash
# Guess: a TrueMap .tmd has one unit of length, so two libraries agree on the size of what it
#   holds.
# Version: surfalize 0.19.2, SurfaceTopography 1.27.1
# Behaviour: surfalize takes the numbers of the file for micrometres, SurfaceTopography for
#   millimetres. Lengths and heights differ by 1000, areas by 1e6; slopes agree, so pictures and
#   angles look right. The file does not state the unit.
# Output seen: the same file: 4.0 x 4.0 um, heights 0 to 33 um (surfalize); 4.0 x 4.0 mm, heights
#   0 to 33 mm (SurfaceTopography)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    surfalize==0.19.2 SurfaceTopography==1.27.1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from SurfaceTopography import read_topography
from surfalize import Surface

row, column = np.mgrid[:4, :4]
Surface(10.0 * row + column, 1.0, 1.0).save("scan.tmd")
surface = Surface.load("scan.tmd")
topography = read_topography("scan.tmd")
width = surface.step_x * surface.data.shape[1]
print(f"surfalize: {width:.3g} um wide, heights up to {surface.data.max():.3g} um")
lengths = topography.physical_sizes[0], topography.heights().max()
print("SurfaceTopography: {:.3g} {u} wide, up to {:.3g} {u}".format(*lengths, u=topography.unit))
assert np.isclose(width, 4) and np.isclose(surface.data.max(), 33), "surfalize: another unit"
assert topography.unit == "mm", "SurfaceTopography: another unit"
assert np.allclose(lengths, (4, 33)), "the numbers differ in another way now"
PYTHON
