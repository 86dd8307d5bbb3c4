#!/usr/bin/env bash
# Guess: flatten(inplace=False) of NSFopen, which "returns the flattened image", and plane_level and
#   denoise beside it leave the image that was read as it is.
# Version: NSFopen 2.2.4 (with scikit-learn, which its process module needs and does not ask for)
# Behaviour: flatten and plane_level work in the array of the image and then return it; with
#   inplace=False the image is changed all the same, and what is returned is the image. Raw and
#   flattened heights that are compared afterwards are equal. denoise does make a new array.
#   plane_level takes square images only.
# Output seen: image changed by up to 82 nm by flatten, by 0 nm by denoise; rms 93 nm
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check NSFopen==2.2.4 numpy==2.4.6 \
    scipy==1.17.1 pandas==3.1.1 h5py==3.16.0 matplotlib==3.11.2 scikit-learn==1.9.1
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
from pathlib import Path

import numpy as np
from NSFopen.process import process

columns, rows = 64, 48
points = (1e8 * np.random.default_rng(0).normal(size=columns * rows)).astype("<i4")
sections = {
    "DataSet": {"Version": 2, "GroupCount": 1, "Gr0-Name": "Scan forward", "Gr0-Count": 1,
                "Gr0-Ch0": "DataSet-0:1"},
    "DataSet-Info": {"Date": "01-01-2025"},
    "DataSet-0:1": {
        "Version": 2, "Points": columns, "Lines": rows, "SaveBits": 32, "Frame": "Scan forward",
        "Dim0Name": "X-Axis", "Dim0Unit": "m", "Dim0Range": 1e-6, "Dim0Min": 0,
        "Dim1Name": "Y-Axis", "Dim1Unit": "m", "Dim1Range": 1e-6, "Dim1Min": 0,
        "Dim2Name": "Z-Axis", "Dim2Unit": "m", "Dim2Range": 4e-6, "Dim2Min": -2e-6,
    },
}
text = "\r\n".join(
    f"[{name}]\r\n" + "".join(f"{key}={value}\r\n" for key, value in section.items())
    for name, section in sections.items()
)
Path("image.nid").write_bytes(text.encode("latin-1") + b"\r\n\r\n#!" + points.tobytes())
heights = 4e-6 * points.reshape(rows, columns) / 2.0**32


def get(image):
    return np.array(image.data["Image"]["Forward"]["Z-Axis"], float)



image = process("image.nid")
assert np.allclose(get(image), heights, atol=1e-12), "other heights are read"
image.denoise(inplace=False)
denoised = np.abs(get(image) - heights).max()
returned = np.array(image.flatten(inplace=False), float)
flattened = np.abs(get(image) - heights).max()
print(f"image changed by up to {1e9 * flattened:.0f} nm by flatten, "
      f"by {1e9 * denoised:.0f} nm by denoise; rms {1e9 * heights.std():.0f} nm")
assert denoised < 1e-12, "denoise changes the image, too"
assert flattened > 0.1 * heights.std(), "flatten leaves the image as it is now"
assert np.array_equal(returned, get(image)), "what is returned is not the image any more"
PYTHON
