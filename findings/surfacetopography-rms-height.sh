#!/usr/bin/env bash
# Guess: fourier_synthesis(..., rms_height=1) of SurfaceTopography makes a rough surface with an
#   rms height of 1, give or take a few per cent.
# Version: SurfaceTopography 1.27.1
# Behaviour: 1 is the mean over all surfaces that it could have made. Of a self-affine one without
#   a long_cutoff a few waves carry most of the height, and it is anything from 0.66 to 1.62; a
#   line from 0.28 to 1.64. Contact area and stiffness of two seeds differ as much. With rms_slope
#   it is right within 8 %, as many waves carry the slope.
# Output seen: 12 seeds: map 0.66 to 1.62, with long_cutoff of a quarter 0.93 to 1.18, rms_slope
#   0.96 to 1.08; line 0.28 to 1.64
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    SurfaceTopography==1.27.1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from SurfaceTopography.Generation import fourier_synthesis


def collect(shape, measure, **options):
    values = []
    for seed in range(12):
        np.random.seed(seed)
        surface = fourier_synthesis(shape, (1.0,) * len(shape), 0.8, **options)
        values.append(float(getattr(surface, measure)()))
    return min(values), max(values)


maps = collect((128, 128), "rms_height_from_area", rms_height=1.0)
short = collect((128, 128), "rms_height_from_area", rms_height=1.0, long_cutoff=0.25)
slopes = collect(
    (128, 128), "rms_gradient", rms_slope=1.0, long_cutoff=0.25, short_cutoff=8 / 128
)
lines = collect((1024,), "rms_height_from_profile", rms_height=1.0)
for name, (least, most) in [("map", maps), ("long_cutoff", short), ("slope", slopes),
                            ("line", lines)]:  # fmt: skip
    print(f"{name}: {least:.2f} to {most:.2f}")
assert slopes[0] > 0.9 and slopes[1] < 1.1, "slopes scatter, too"
assert maps[1] > 1.5 * maps[0], "maps have the rms height that was asked for now"
assert lines[1] > 2 * lines[0], "lines have the rms height that was asked for now"
PYTHON
