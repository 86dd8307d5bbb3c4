#!/usr/bin/env bash
# Guess: a .gwy of 6 by 4 points is an image of 4 rows and 6 columns for every reader.
# Version: AFMReader 0.0.7, gwyfile 0.3.0
# Behaviour: AFMReader puts the values, which are stored row by row, into an array of 6 rows and 4
#   columns. Rows break in the wrong place and the pixel, length over columns, is 3/2 of the true
#   one. The image looks like a sheared, streaky scan; nothing is reported. Square images are
#   right.
# Output seen: 4 x 6 of gwyfile: first row 0 1 2 3 4 5 nm, 1000 nm a pixel; 6 x 4 of AFMReader:
#   first rows 0 1 2 3 and 4 5 10 11 nm, 1500 nm a pixel
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    AFMReader==0.0.7 gwyfile==0.3.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import gwyfile
import numpy as np
from AFMReader.gwy import load_gwy
from gwyfile.objects import GwyContainer, GwyDataField, GwySIUnit
from loguru import logger

logger.remove()


def read(rows, columns):
    row, column = np.mgrid[:rows, :columns]
    heights, metre = 1e-9 * (10.0 * row + column), GwySIUnit(unitstr="m")
    container = GwyContainer()
    container["/0/data/title"] = "Height"
    container["/0/data"] = GwyDataField(
        heights, xreal=1e-6 * columns, yreal=1e-6 * rows, si_unit_xy=metre, si_unit_z=metre
    )
    container.tofile("scan.gwy")
    again = gwyfile.load("scan.gwy")["/0/data"].data
    assert np.array_equal(again, heights), "gwyfile does not read what it wrote"
    return 1e9 * heights, *load_gwy("scan.gwy", "Height")


true, image, pixel = read(4, 4)
assert np.allclose(image, true) and np.isclose(pixel, 1000), "square images are wrong, too"
true, image, pixel = read(4, 6)
print(true, image, f"{pixel} nm a pixel", sep="\n")
assert image.shape == (6, 4) and np.allclose(image, true.reshape(6, 4)), "another order of points"
assert np.isclose(pixel, 1500), "another pixel"
PYTHON
