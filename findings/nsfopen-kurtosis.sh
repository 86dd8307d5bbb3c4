#!/usr/bin/env bash
# Guess: Sku among the statistics of NSFopen is that of ISO 25178, 3 for a surface with normally
#   distributed heights; above 3 the surface has spikes.
# Version: NSFopen 2.2.4 (with scikit-learn, which its process module needs and does not ask for)
# Behaviour: 3 is taken off: it is 0 for such a surface and 1.5 - 3 for a wave. Sa, Sq and Ssk
#   beside it are those of the standard. A surface of 4 here has more spikes than one of 6 there.
# Output seen: random heights: NSFopen -0.05, standard 2.95; Sq and Ssk agree
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
found = image.stats()
found = {name: float(found["Forward"]["Z-Axis"][name]) for name in ("Sq", "Ssk", "Sku")}
shifted = heights - heights.mean()
rms = np.sqrt(np.mean(shifted**2))
skewness, kurtosis = (float(np.mean(shifted**power) / rms**power) for power in (3, 4))
print(f"random heights: NSFopen {found['Sku']:.2f}, standard {kurtosis:.2f}")
assert np.isclose(found["Sq"], rms) and np.isclose(found["Ssk"], skewness), "more of them are off"
assert abs(kurtosis - 3) < 0.3, "the heights are not normal"
assert np.isclose(found["Sku"], kurtosis - 3), "the kurtosis is that of the standard now"
PYTHON
