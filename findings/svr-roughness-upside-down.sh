#!/usr/bin/env bash
# Guess: the height grid of svr_roughness, after its plane is taken off, has peaks where the points
#   lie high, whatever the tilt of the scan was.
# Version: svr_roughness 0.8.5
# Behaviour: the side that is up is the one that makes the axes of the plane right-handed; of these
#   two may point either way. A tilt of a degree decides whether pits are pits or peaks. Sq and Svr
#   do not tell; the skewness of the heights, their largest value and the map change sign.
# Output seen: a plate with pits, skewness -4.35: level 4.43 (upside down), tilted by half a degree
#   or one, to either side -4.42, by three degrees 4.42
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    svr_roughness==0.8.5 numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from svr_roughness import analyze_points

random = np.random.default_rng(0)
x, y = np.meshgrid(0.2 * np.arange(300), 0.2 * np.arange(300))  # mm
heights = 0.01 * random.normal(size=x.shape)
for _ in range(30):
    left, low = random.uniform(3, 57, 2)
    heights -= 0.3 * np.exp(-((x - left) ** 2 + (y - low) ** 2) / 2)


def skewness(values):
    values = values[np.isfinite(values)]
    return float(np.mean((values - values.mean()) ** 3) / values.std() ** 3)


def analyse(tilt):
    points = np.column_stack([a.ravel() for a in (x, y, heights + tilt * x + 0.3 * tilt * y)])
    result = analyze_points(points)
    return skewness(result.elevation_grid), result.sq_um


true = skewness(heights)
tilts = (0.0, 0.01, 0.02, -0.01, -0.02, 0.05, -0.05)
found = {tilt: analyse(tilt) for tilt in tilts}
for tilt, (skew, sq) in found.items():
    print(f"tilt {tilt}: skewness {skew:.2f} (true {true:.2f}), Sq {sq:.1f} um")
skews, sqs = np.array(list(found.values())).T
assert np.allclose(abs(skews), abs(true), rtol=0.1), "the heights have another shape"
assert np.ptp(sqs) < 0.1 * sqs.mean(), "Sq depends on the tilt, too"
assert skews.min() < 0 < skews.max(), "up is the same side for all tilts now"
PYTHON
