#!/usr/bin/env bash
# Guess: a force curve of Asylum Research (.ibw) that goes in and out is loaded as an approach and
#   a retraction.
# Version: afmformats 0.18.7, igor2 0.5.15
# Behaviour: all rows are segment 0. The "approach" holds both passes and the retraction is empty,
#   so a fit of the approach averages over loading and unloading, adhesion included.
# Output seen: 1000 rows, approach 1000, retraction 0, largest force in row 499
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    afmformats==0.18.7 igor2==0.5.15 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import struct
from pathlib import Path

import afmformats
import numpy as np


def write_ibw(path, columns, note):
    """A version 5 binary wave: header with its checksum, columns, note, labels."""
    data = np.column_stack(list(columns.values())).astype("<f4")
    labels = b"".join(name.encode().ljust(32, b"\0") for name in ["", *columns])
    note = "\r".join(f"{key}: {value}" for key, value in note.items()).encode()
    head = bytearray(384)
    struct.pack_into("<hhiii", head, 0, 5, 0, 320 + data.nbytes, 0, len(note))
    struct.pack_into("<i", head, 40, len(labels))
    struct.pack_into("<ih", head, 76, data.size, 2)
    struct.pack_into("<h", head, 90, 1)
    head[92:97] = b"curve"
    struct.pack_into("<4i8d", head, 132, *data.shape, 0, 0, *[1.0] * 4, *[0.0] * 4)
    checksum = -sum(struct.unpack("<192h", head))
    struct.pack_into("<h", head, 2, (checksum + 2**15) % 2**16 - 2**15)
    path.write_bytes(bytes(head) + data.T.tobytes() + note + labels)


n, constant = 500, 0.05
indentation = np.concatenate([np.linspace(-2e-6, 5e-7, n), np.linspace(5e-7, -2e-6, n)])
deflection = 3e3 * np.sqrt(5e-6) * np.maximum(indentation, 0) ** 1.5 / constant
note = {
    "ScanSize": 1e-6, "ImagingMode": "Contact", "NumPtsPerSec": 1000, "InvOLS": 5e-8,
    "TriggerChannel": "Deflection", "SpringConstant": constant, "InputTime": 1.0,
    "ApproachVelocity": 5e-6, "RetractVelocity": 5e-6, "MicroscopeModel": "MFP3D",
    "Version": 1, "Date": "2020-01-01", "Time": "12:00:00 PM", "EndOfNote": 1,
}  # fmt: skip
height = indentation + deflection
write_ibw(Path("curve.ibw"), {"Raw": height, "Defl": deflection, "ZSnsr": height}, note)
curve = afmformats.load_data("curve.ibw")[0]
turn = int(np.argmax(curve["force"]))
rows, approach, retraction = len(curve), len(curve.appr["force"]), len(curve.retr["force"])
print(f"{rows} rows, approach {approach}, retraction {retraction}, largest force in row {turn}")
assert abs(turn - n) < 2, "the file does not turn in the middle"
assert (rows, approach, retraction) == (2 * n, 2 * n, 0), "the passes are split now"
PYTHON
