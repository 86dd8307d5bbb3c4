#!/usr/bin/env bash
# Guess: AFMReader gives the size of a pixel of an Asylum image (.ibw) whose scan is wide and low, 4
#   by 1 um with 64 points in each of 16 lines: 62.5 nm along and across.
# Version: AFMReader 0.0.7, gwyddionpy 0.1.0 (reads with Gwyddion)
# Behaviour: the slow size is divided by the number of points in a line, so a pixel has 15.6 nm; all
#   lengths are too small by the ratio of the sides, areas by its square. The heights are in the
#   right places. Square scans are right.
# Output seen: 64 x 16 points: AFMReader 15.6 nm, Gwyddion 62.5 nm; 16 x 16 points 62.5 and 62.5 nm
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



def compare(columns, lines, sizes):
    heights = 1e-9 * np.arange(lines * columns, dtype=float).reshape(lines, columns)
    write_ibw(Path("scan.ibw"), {"HeightTrace": heights}, sizes)
    image, pixel = load_ibw("scan.ibw", "HeightTrace")
    (channel,) = gwyddionpy.load("scan.ibw").channels.values()
    right = np.asarray(channel.data)
    assert np.allclose(image, 1e9 * right, rtol=1e-5), "the heights are in other places"
    other = 1e9 * channel.xreal / right.shape[1]
    print(f"{columns} x {lines} points: AFMReader {pixel:.1f} nm, Gwyddion {other:.1f} nm")
    return pixel, other


wide, square = compare(64, 16, (4e-6, 1e-6)), compare(16, 16, (1e-6, 1e-6))
assert np.allclose(square, 62.5), "a square scan is wrong, too"
assert np.isclose(wide[1], 62.5), "Gwyddion has another pixel"
assert np.isclose(wide[0], 62.5 / 4), "a wide scan is right now"
PYTHON
