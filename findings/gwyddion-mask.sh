#!/usr/bin/env bash
# Guess: a mask in a .gwy is a mark for the eye, such as the grains that were counted; the heights
#   below it are read as they are.
# Version: SurfaceTopography 1.27.1, surfalize 0.19.2, gwyfile 0.3.0
# Behaviour: SurfaceTopography and surfalize take masked points for missing ones. A scan whose
#   peaks were marked as grains loses its peaks, where contact begins; filled in from their
#   surroundings they are lower. gwyfile gives all heights.
# Output seen: 16 x 16 points, 9 marked, highest 100 nm: SurfaceTopography 247 points, highest
#   36.8 nm; surfalize 247 points, highest 36.8 nm
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    SurfaceTopography==1.27.1 surfalize==0.19.2 gwyfile==0.3.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import gwyfile
import numpy as np
from gwyfile.objects import GwyContainer, GwyDataField, GwySIUnit
from SurfaceTopography import read_topography
from surfalize import Surface

place = np.arange(16) - 8
heights = 100e-9 * np.exp(-np.add.outer(place**2, place**2) / 4)
grains = (heights > 50e-9).astype(float)
metre = GwySIUnit(unitstr="m")
container = GwyContainer()
container["/0/data/title"] = "Height"
for name, values in [("/0/data", heights), ("/0/mask", grains)]:
    container[name] = GwyDataField(
        values, xreal=1e-6, yreal=1e-6, si_unit_xy=metre, si_unit_z=metre
    )
container.tofile("scan.gwy")

stored = gwyfile.load("scan.gwy")["/0/data"].data
assert np.array_equal(stored, heights), "gwyfile does not give the stored heights"
topography = read_topography("scan.gwy")
first = 1e9 * np.ma.compressed(topography.heights())
second = Surface.load("scan.gwy").data
second = 1e3 * second[np.isfinite(second)]
print(f"{heights.size} points, {int(grains.sum())} marked, highest {1e9 * heights.max():.1f} nm")
for name, read in [("SurfaceTopography", first), ("surfalize", second)]:
    print(f"{name}: {read.size} points, highest {read.max():.1f} nm")
    assert read.size == heights.size - grains.sum(), f"{name} keeps marked points now"
    assert np.isclose(read.max(), 1e9 * heights[grains == 0].max()), f"{name}: other heights"
PYTHON
