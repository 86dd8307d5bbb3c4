#!/usr/bin/env bash
# Guess: export_data of spm-tools writes heights to a .gsf (Gwyddion Simple Field) that other
#   programs read back, with the size of the image.
# Version: spm-tools 0.1.1 (for Python 3.11 and 3.12, as it needs numpy 1), gsffile 0.5.5,
#   gwyddionpy 0.1.0 (reads with Gwyddion)
# Behaviour: the format holds single precision; doubles, numpy's usual heights, are written as they
#   are, and neither Gwyddion nor gsffile reads the file. Singles are read, but the size along n
#   points is n - 1/n steps, not n.
# Output seen: doubles: refused by gsffile and Gwyddion; singles of 4 x 3 points, 1 apart: 3.75 by
#   2.67 (true 4 by 3)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==1.26.4 scipy==1.11.4 \
    spm-tools==0.1.1 gsffile==0.5.5 gwyddionpy==0.1.0 gwyddionpy-converter==0.1.0
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import gwyddionpy
import numpy as np
from gsffile import read_gsf
from spm_tools.io import export_data

heights = 1 + np.arange(12.0).reshape(3, 4)


def read_gwyddion():
    (channel,) = gwyddionpy.load("image.gsf").channels.values()
    return np.asarray(channel.data), (channel.xreal, channel.yreal)


def read_gsffile():
    values, header = read_gsf("image.gsf")
    return values, (header["XReal"], header["YReal"])


seen = {}
for kind in (np.float64, np.float32):
    export_data(heights.astype(kind), path="image.gsf")
    for read in (read_gsffile, read_gwyddion):
        try:
            values, size = read()
        except (ValueError, gwyddionpy.UnsupportedFormatError):
            seen[kind, read] = "refused"
        else:
            assert np.array_equal(values, heights), "other heights"
            seen[kind, read] = tuple(round(float(length), 2) for length in size)
        print(kind.__name__, read.__name__, seen[kind, read])
doubles = {seen[np.float64, read] for read in (read_gsffile, read_gwyddion)}
singles = {seen[np.float32, read] for read in (read_gsffile, read_gwyddion)}
assert doubles == {"refused"}, "doubles are read now"
assert singles == {(3.75, 2.67)}, "singles have another size now"
PYTHON
