#!/usr/bin/env bash
# Guess: a surface that sdfio writes as .sdf has its first row first for whoever reads it, in each
#   of the revisions of the format that it offers.
# Version: sdfio 2.0.0 (writes), gwyddionpy 0.1.0 (reads with Gwyddion)
# Behaviour: in ISO-1.0 it has. In BCR-1.0, the older text of the same format with the same header,
#   sdfio takes the rows to run the other way and writes the last one first; Gwyddion reads both
#   alike. The image is upside down, a groove at +30 degrees is one at -30 degrees. sdfio itself
#   turns it back.
# Output seen: heights in front of the rows 5.0 5.4 5.8 um: ISO-1.0 5.0 5.4 5.8, BCR-1.0 5.8 5.4 5.0
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    sdfio==2.0.0 gwyddionpy==0.1.0 gwyddionpy-converter==0.1.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import gwyddionpy
import numpy as np
import sdfio

heights = 1e-6 * (5 + 0.1 * np.arange(12.0).reshape(3, 4))


def read(revision, kind):
    metadata = sdfio.Metadata(revision=revision)
    form = {"format": kind, "metadata": metadata}
    sdfio.write("surface.sdf", heights, x_scale=5e-7, y_scale=2.5e-7, **form)
    assert np.allclose(sdfio.read("surface.sdf").data, heights), "sdfio reads other heights"
    (channel,) = gwyddionpy.load("surface.sdf").channels.values()
    found = np.asarray(channel.data)
    print(revision.value, kind.name, *(f"{1e6 * height:.1f}" for height in found[:, 0]), "um")
    return found


for kind in (sdfio.FileFormat.ASCII, sdfio.FileFormat.BINARY):
    iso, bcr = read(sdfio.Revision.ISO_1_0, kind), read(sdfio.Revision.BCR_1_0, kind)
    assert np.allclose(iso, heights), "ISO-1.0 is upside down, too"
    assert np.allclose(bcr, heights[::-1]), "BCR-1.0 is not upside down any more"
PYTHON
