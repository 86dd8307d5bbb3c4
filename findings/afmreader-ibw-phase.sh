#!/usr/bin/env bash
# Guess: AFMReader gives the phase of an Asylum image (.ibw) in degrees, as the file has it, and as
#   it gives that of a .jpk.
# Version: AFMReader 0.0.7, gwyddionpy 0.1.0 (reads with Gwyddion)
# Behaviour: every channel is taken for a height in metres and multiplied by 1e9: 30 degrees are
#   3e10, a signal in V is in nV, and nothing says so. The loader of .jpk looks at the name of the
#   channel and multiplies heights and amplitudes only.
# Output seen: height AFMReader 5.0, Gwyddion 5.0e-09 m; phase AFMReader 3.0e+10, Gwyddion 30 deg
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 igor2==0.5.15 loguru==0.7.3 gwyddionpy==0.1.0 gwyddionpy-converter==0.1.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps AFMReader==0.0.7
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import struct
from pathlib import Path

import gwyddionpy
import numpy as np
from AFMReader.ibw import load_ibw
from loguru import logger

logger.remove()


def write_ibw(path, channels, sizes):
    """A version 5 binary wave of images: points of a line, lines, channels; note, labels."""
    data = np.stack([image.T for image in channels.values()], axis=2).astype("<f4")
    labels = b"".join(name.encode().ljust(32, b"\0") for name in ["", *channels])
    note = "ImagingMode: 1\rFastScanSize: {}\rSlowScanSize: {}\rEnd: 1".format(*sizes).encode()
    head = bytearray(384)
    struct.pack_into("<hhiii", head, 0, 5, 0, 320 + data.nbytes, 0, len(note))
    struct.pack_into("<i", head, 44, len(labels))
    struct.pack_into("<ih", head, 76, data.size, 2)
    struct.pack_into("<h", head, 90, 1)
    head[92:97] = b"image"
    steps = [size / count for size, count in zip(sizes, data.shape)]
    struct.pack_into("<4i8d", head, 132, *data.shape, 0, *steps, 1.0, 1.0, *[0.0] * 4)
    checksum = -sum(struct.unpack("<192h", head))
    struct.pack_into("<h", head, 2, (checksum + 2**15) % 2**16 - 2**15)
    path.write_bytes(bytes(head) + data.tobytes("F") + note + labels)



images = {"HeightTrace": np.full((8, 8), 5e-9), "PhaseTrace": np.full((8, 8), 30.0)}
write_ibw(Path("scan.ibw"), images, (1e-6, 1e-6))
channels = gwyddionpy.load("scan.ibw").channels.values()
found = {name: float(load_ibw("scan.ibw", name)[0][0, 0]) for name in images}
right = [float(np.asarray(channel.data)[0, 0]) for channel in channels]
units = [channel.si_unit_z for channel in channels]
for name, other, unit in zip(images, right, units):
    print(f"{name}: AFMReader {found[name]:.1e}, Gwyddion {other:.1e} {unit}")
assert np.allclose(right, [5e-9, 30]), "Gwyddion reads other values"
assert np.isclose(found["HeightTrace"], 5), "the height is not in nm"
assert np.isclose(found["PhaseTrace"], 3e10), "the phase is left in degrees now"
PYTHON
