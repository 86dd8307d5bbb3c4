#!/usr/bin/env bash
# Guess: forward and backward image of a Nanonis .sxm, as nanonispy2 gives them, lie on one
#   another, first row on top, so their difference is friction or hysteresis.
# Version: nanonispy2 1.2.0, gwyddionpy 0.1.0 (reads with Gwyddion)
# Behaviour: the file has the points in the order of time. nanonispy2 gives them so: the backward
#   image is the mirror image of the forward one, and a scan that ran upwards is upside down.
#   Gwyddion turns both. The header (SCAN_DIR) says which way; nothing says it of the mirror.
# Output seen: nanonispy2, forward and backward: rows begin with 0 1 2 3 and 3 2 1 0 nm; Gwyddion:
#   both 0 1 2 3; scan up, first row: nanonispy2 0 1 2 3, Gwyddion 20 21 22 23 nm
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    nanonispy2==1.2.0 gwyddionpy==0.1.0 gwyddionpy-converter==0.1.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import gwyddionpy
import numpy as np
from nanonispy2.read import Scan

nx, ny = 4, 3
heights = np.add.outer(10.0 * np.arange(ny), np.arange(nx))  # nm, in the order of the rows' times


def read(direction):
    header = {
        "NANONIS_VERSION": "2", "SCANIT_TYPE": "FLOAT            MSBFIRST",
        "REC_DATE": "01.01.2025", "REC_TIME": "12:00:00", "REC_TEMP": "290.0", "ACQ_TIME": "10.0",
        "SCAN_PIXELS": f"{nx} {ny}", "SCAN_FILE": "scan.sxm", "SCAN_TIME": "1.0E+0 1.0E+0",
        "SCAN_RANGE": "4.0E-9 3.0E-9", "SCAN_OFFSET": "0.0E+0 0.0E+0", "SCAN_ANGLE": "0.0E+0",
        "SCAN_DIR": direction, "BIAS": "1.0E-1",
        "DATA_INFO": "\tChannel\tName\tUnit\tDirection\tCalibration\tOffset\n"
        "\t14\tZ\tm\tboth\t1.0E-9\t0.0E+0\n",
    }
    text = "".join(f":{name}:\n{value}\n" for name, value in header.items())
    points = np.stack([heights, heights[:, ::-1]]) * 1e-9  # there and back
    with open("scan.sxm", "wb") as file:
        file.write(text.encode() + b":SCANIT_END:\n\n\n\x1a\x04" + points.astype(">f4").tobytes())
    scan = Scan("scan.sxm").signals["Z"]
    channels = list(gwyddionpy.load("scan.sxm").channels.values())
    images = [scan["forward"], scan["backward"], *(channel.data for channel in channels)]
    return [np.round(np.asarray(image, float) * 1e9, 3) for image in images]


down, up = read("down"), read("up")
for name, images in [("down", down), ("up", up)]:
    print(name, "first rows: nanonispy2", *(image[0] for image in images[:2]),
          "Gwyddion", *(image[0] for image in images[2:]))
assert np.array_equal(down[0], heights) and np.array_equal(down[2], heights), "forward is turned"
assert np.array_equal(down[3], heights), "Gwyddion does not turn the backward image any more"
assert np.array_equal(down[1], heights[:, ::-1]), "nanonispy2 turns the backward image now"
assert np.array_equal(up[2], heights[::-1]), "Gwyddion does not turn a scan upwards any more"
assert np.array_equal(up[0], heights), "nanonispy2 turns a scan upwards now"
PYTHON
