#!/usr/bin/env bash
# Guess: two .sur files (Digital Surf) of one surface, before and after it has sunk by 5 um, differ
#   by 5 um for whoever reads them.
# Version: surfalize 0.19.2 (writes), SurfaceTopography 1.27.1, gwyddionpy 0.1.0 (reads with
#   Gwyddion)
# Behaviour: the format has integers, a step and an offset of the heights. surfalize and Gwyddion
#   add the offset; SurfaceTopography leaves it out: each surface lies around zero and the two are
#   the same. Shape and sizes agree. Written as .sdf, they differ by 5 um there, too.
# Output seen: surfalize 5.00 um, Gwyddion 5.00 um, SurfaceTopography 0.00 um; as .sdf 5.00 um
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check surfalize==0.19.2 \
    SurfaceTopography==1.27.1 gwyddionpy==0.1.0 gwyddionpy-converter==0.1.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import gwyddionpy
import numpy as np
import SurfaceTopography
from surfalize import Surface

heights = 0.1 * np.arange(12.0).reshape(3, 4)  # um


def read(name):
    (channel,) = gwyddionpy.load(name).channels.values()
    topography = SurfaceTopography.read_topography(name)
    found = {
        "surfalize": Surface.load(name).data,
        "Gwyddion": 1e6 * np.asarray(channel.data),
        "SurfaceTopography": np.asarray(topography.heights(), float).T,
    }
    for values in found.values():
        assert np.allclose(values - values[0, 0], heights, atol=1e-3), "another shape"
    return found


def compare(suffix):
    for name, offset in (("before", 5.0), ("after", 0.0)):
        Surface(heights + offset, 0.5, 0.25).save(f"{name}{suffix}")
    before, after = read(f"before{suffix}"), read(f"after{suffix}")
    sunk = {name: float(np.mean(before[name] - after[name])) for name in before}
    print(suffix, *(f"{name} {value:.2f} um" for name, value in sunk.items()))
    return sunk


integers, doubles = compare(".sur"), compare(".sdf")
assert np.allclose(list(doubles.values()), 5), "as .sdf they are wrong, too"
assert np.allclose([integers["surfalize"], integers["Gwyddion"]], 5, atol=1e-3), "more are wrong"
assert abs(integers["SurfaceTopography"]) < 1e-3, "SurfaceTopography adds the offset now"
PYTHON
