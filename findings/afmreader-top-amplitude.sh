#!/usr/bin/env bash
# Guess: the heights of a WSxM .top are scaled to the "Z Amplitude" of its header, unit included.
# Version: AFMReader 0.0.7, SurfaceTopography 1.27.1
# Behaviour: AFMReader takes the digits before the decimal point and no unit: 12.7 nm becomes 12
#   nm, 0.8 um a flat plane, 3.9 um three nanometres. SurfaceTopography reads number and unit.
# Output seen: 12.7 nm: 12.7 nm and 12.0; 0.8 um: 0.8 um and 0.0; 3.9 um: 3.9 um and 3.0
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    AFMReader==0.0.7 SurfaceTopography==1.27.1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
from pathlib import Path

import numpy as np
from AFMReader.top import load_top
from loguru import logger
from SurfaceTopography import read_topography

logger.remove()
row, column = np.mgrid[:4, :4]
raw = (100 * (10 * row + column)).astype("<i2")
lines = [
    "WSxM file copyright UAM", "SxM Image file", "Image header size: {size}", "",
    "[Control]", "", "    X Amplitude: 500.0 nm", "    Y Amplitude: 500.0 nm", "",
    "[General Info]", "", "    Image Data Type: short", "    Number of columns: 4",
    "    Number of rows: 4", "    Z Amplitude: {amplitude}", "",
    "[Miscellaneous]", "", "    Maximum: 3300", "    Minimum: 0", "", "[Header end]", "",
]  # fmt: skip


def ranges(amplitude):
    def header(size):
        text = "\r\n".join(lines).format(size=size, amplitude=amplitude)
        return text.encode("latin-1")

    Path("scan.top").write_bytes(header(len(header(100))) + raw.tobytes())
    topography = read_topography("scan.top")
    heights, image = topography.heights(), load_top("scan.top")[0]
    print(f"{amplitude}: {np.ptp(heights):.3g} {topography.unit} and {np.ptp(image):.3g} nm")
    return np.ptp(heights), np.ptp(image)


for amplitude, value, seen in [("12.7 nm", 12.7, 12), ("0.8 µm", 0.8, 0), ("3.9 µm", 3.9, 3)]:
    sound, other = ranges(amplitude)
    assert np.isclose(sound, value), "SurfaceTopography reads another amplitude"
    assert np.isclose(other, seen), "AFMReader reads another amplitude"
PYTHON
