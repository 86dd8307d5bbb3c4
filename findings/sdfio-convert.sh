#!/usr/bin/env bash
# Guess: sdfio convert -t int16, and with_revision(refit_z_scale=True), store heights as integers
#   with a step that fits them.
# Version: sdfio 2.0.0
# Behaviour: the step of the file is kept if "the data fits", and a file of doubles that sdfio wrote
#   has a step of 1 m. Heights of micrometres fit into 16 bits of 1 m each: all of them are 0, the
#   exit status is 0. Only heights too large for the old step get a new one. suggest_z_scale gives
#   the right step.
# Output seen: heights 5.0 to 6.1 um: int16 0.0 to 0.0 um, step 1 m; int32 0.0 to 0.0 um; suggested
#   step 1.9e-10 m
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check sdfio==2.0.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import subprocess
import sys
from pathlib import Path

import numpy as np
import sdfio

heights = 1e-6 * (5 + 0.1 * np.arange(12.0).reshape(3, 4))
sdfio.write("doubles.sdf", heights, x_scale=5e-7, y_scale=2.5e-7)
assert np.allclose(sdfio.read("doubles.sdf").data, heights, rtol=1e-12), "doubles are wrong, too"
program, found = Path(sys.executable).with_name("sdfio"), {}
for kind in ("int16", "int32"):
    target = f"{kind}.sdf"
    subprocess.run([program, "convert", "-t", kind, "doubles.sdf", target], check=True)
    found[kind] = sdfio.read(target)
    low, high = 1e6 * found[kind].data.min(), 1e6 * found[kind].data.max()
    print(f"{kind}: {low:.1f} to {high:.1f} um, step {found[kind].header.z_scale:.0f} m")
refit = sdfio.read("doubles.sdf").with_revision(
    sdfio.Revision.ISO_2_0, data_type=sdfio.DataType.INT16, refit_z_scale=True
)
step = sdfio.suggest_z_scale(heights, sdfio.DataType.INT16, sdfio.Revision.ISO_2_0)
print(f"suggested step {step:.1e} m")
assert step < 1e-9, "the suggested step is another one"
assert all(not file.data.any() for file in found.values()), "the heights are kept now"
assert refit.header.z_scale == 1, "the step is fitted now"
PYTHON
