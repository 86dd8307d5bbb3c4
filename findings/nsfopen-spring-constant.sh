#!/usr/bin/env bash
# Guess: the spring constant of the thermal tuning that NSFopen reads from a .nid (Nanosurf) is the
#   one in the file.
# Version: NSFopen 2.2.4
# Behaviour: it is where the number has a decimal point. Without one, a single digit before the
#   unit is taken: 40 N/m is read as "0", 42 N/m as "2", without a word; a peak of 12 pm is "1", in
#   the unit "2pm". A force that is computed with it is zero or a twentieth.
# Output seen: 0.25 N/m: 0.25; 40.0 N/m: 40.0; 40 N/m: 0; 42 N/m: 2
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check NSFopen==2.2.4 \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 h5py==3.16.0 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
from pathlib import Path

import numpy as np
from NSFopen.read import read

points = np.arange(-6, 6, dtype="<i4")
image = {
    "Version": 2, "Points": 4, "Lines": 3, "SaveBits": 32, "Frame": "Scan forward",
    "Dim0Name": "X-Axis", "Dim0Unit": "m", "Dim0Range": 1e-6, "Dim0Min": 0,
    "Dim1Name": "Y-Axis", "Dim1Unit": "m", "Dim1Range": 1e-6, "Dim1Min": 0,
    "Dim2Name": "Z-Axis", "Dim2Unit": "m", "Dim2Range": 2.0**32, "Dim2Min": -(2.0**31),
}
sets = {"Version": 2, "GroupCount": 1, "Gr0-Name": "Scan forward", "Gr0-Count": 1,
        "Gr0-Ch0": "DataSet-0:1"}


def load(spring, peak="12.5 pm"):
    tuning = {"-- Thermal Tuning --": "", "Spring Constant:": spring, "Frequency:": "75.5kHz",
              "Q Factor:": "210", "Peak Value:": peak}
    sections = {"DataSet": sets, "DataSet-Info": tuning, "DataSet-0:1": image}
    text = "\r\n".join(
        f"[{name}]\r\n" + "".join(f"{key}={value}\r\n" for key, value in section.items())
        for name, section in sections.items()
    )
    Path("tuned.nid").write_bytes(text.encode("latin-1") + b"\r\n\r\n#!" + points.tobytes())
    file = read("tuned.nid")
    heights = np.asarray(file.data["Image"]["Forward"]["Z-Axis"], float)
    assert np.allclose(heights.ravel(), points), "the heights are wrong, too"
    tune = file.param["Tune"]
    return tune["Spring Constant"], tune["Peak"]


constants = {text: load(f"{text} N/m")[0] for text in ("0.25", "40.0", "40", "42")}
print("; ".join(f"{text} N/m: {found['Value']}" for text, found in constants.items()))
peak = load("0.25 N/m", "12pm")[1]
assert constants["0.25"] == {"Value": "0.25", "Unit": "N/m"}, "with a point it is wrong, too"
assert constants["40.0"]["Value"] == "40.0", "with a point it is wrong, too"
assert constants["40"]["Value"] == "0" and constants["42"]["Value"] == "2", "40 is read as 40 now"
assert peak == {"Value": "1", "Unit": "2pm"}, "the peak is read as 12 pm now"
PYTHON
