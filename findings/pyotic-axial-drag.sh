#!/usr/bin/env bash
# Guess: drag() of PyOTIC gives the drag of a bead that moves towards a wall with lateral=False ("if
#   false, the axial one"); close to the wall it is about twice that along the wall.
# Version: pyotic 0.17.4 (with two names put back that Python has dropped since)
# Behaviour: both are the drag along the wall: `lateral` has no effect. faxen_factor of the same
#   module has the two cases, and its axial one is right.
# Output seen: at a height of 2 radii, over Stokes: drag lateral 1.391, axial 1.391;
#   faxen_factor lateral 1.386, axial 2.125
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==1.23.5 scipy==1.9.3 matplotlib==3.7.5 lmfit==1.2.2 pint==0.22 pandas==1.5.3 \
    ipython==7.34.0 ipykernel==6.29.5 setuptools==69.5.1
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps pyotic==0.17.4
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import collections
import collections.abc
import inspect

import numpy as np

collections.Iterable = collections.abc.Iterable
inspect.getargspec = inspect.getfullargspec
from pyotc import drag, faxen_factor

radius, temperature = 0.5e-6, 298.15  # m, K
height = 2 * radius
free = drag(radius, temperature).real
found = [drag(radius, temperature, height=height, lateral=way).real / free for way in (True, False)]
faxen = [faxen_factor(height, radius, lateral=way) for way in (True, False)]
print("over Stokes: drag lateral {:.3f}, axial {:.3f}; ".format(*found)
      + "faxen_factor lateral {:.3f}, axial {:.3f}".format(*faxen))
# the axial drag of a sphere at this height: Brenner's series gives 2.1255
assert np.isclose(faxen[1], 2.1255, rtol=1e-3), "faxen_factor is wrong, too"
assert np.isclose(found[0], faxen[0], rtol=0.01), "the drag along the wall is wrong, too"
assert found[1] == found[0], "the axial drag is another one now"
PYTHON
