#!/usr/bin/env bash
# Guess: calculate_region_properties of AFMSlicer has one entry for each label of the segmented
#   image, as its twin for stacks of layers (region_properties_by_slices) has.
# Version: afmslicer 0.0.1 (without TopoStats, which this module does not use)
# Behaviour: it counts labels in 8 bits with a sign. From 128 pores on, labels are negative and left
#   out; beyond 256 they begin again and pores far apart are one of twice the area. The twin has
#   32 bits.
# Output seen: 100 pores: 100 and 100; 200 pores: 127 and 200, total area 127 and 200;
#   400 pores: 127 and 400, largest 2 and 1
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==2.2.6 scipy==1.15.3 \
    scikit-image==0.25.2 loguru==0.7.3 pandas==2.2.3 snoop==0.6.0 packaging==24.2
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps afmslicer==0.0.1
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import numpy as np
from afmslicer import slicer
from skimage.measure import label

pores = {}
for count in (100, 200, 400):
    image = np.zeros((30, 120), int)
    # pores of one pixel, none touches another
    image[1::3, 1::3] = np.arange(400).reshape(10, 40) < count
    labels = label(image)
    one = slicer.calculate_region_properties(labels, spacing=1.0)
    twin = slicer.region_properties_by_slices(labels[:, :, None], spacing=1.0)[0]
    areas = [[pore.area for pore in found] for found in (one, twin)]
    pores[count] = areas
    print(f"{count} pores: {len(areas[0])} and {len(areas[1])}, total area {sum(areas[0]):.0f} and "
          f"{sum(areas[1]):.0f}, largest {max(areas[0]):.0f} and {max(areas[1]):.0f}")
for count, (one, twin) in pores.items():
    assert len(twin) == count and max(twin) == 1, "stacks of layers are wrong, too"
assert len(pores[100][0]) == 100, "few pores are wrong, too"
assert len(pores[200][0]) == 127, "200 pores are another number now"
assert max(pores[400][0]) == 2, "400 pores are not merged any more"
PYTHON
