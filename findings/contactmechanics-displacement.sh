#!/usr/bin/env bash
# Guess: a periodic surface, computed as one period or as 2 x 2 periods of it at the same mean
#   pressure, sinks in by the same amount.
# Version: ContactMechanics 1.8.3, SurfaceTopography 1.27.1
# Behaviour: contact area and mean gap agree, displacement and offset do not. Without stiffness_q0
#   the uniform pressure, which has no finite displacement on a periodic half-space, gets the
#   compliance of the longest wave that fits into the domain. The mean displacement p L / (pi E*)
#   grows with the domain, so a stiffness dF/d(offset) depends on the size of the domain.
# Output seen: one period: area 0.1377, mean gap 0.0500, mean displacement 0.0064; 2 x 2: area
#   0.1377, mean gap 0.0500, mean displacement 0.0127
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    ContactMechanics==1.8.3 SurfaceTopography==1.27.1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from ContactMechanics import PeriodicFFTElasticHalfSpace
from ContactMechanics.Systems import NonSmoothContactSystem
from SurfaceTopography import Topography

points, pressure = 32, 0.02


def contact(periods):
    n, sizes = points * periods, (float(periods), float(periods))
    wave = 0.05 * np.cos(2 * np.pi * np.arange(n) / points)
    surface = Topography(np.add.outer(wave, wave), sizes, periodic=True)
    substrate = PeriodicFFTElasticHalfSpace((n, n), 1.0, sizes)
    system = NonSmoothContactSystem(substrate=substrate, surface=surface)
    result = system.minimize_proxy(
        external_force=pressure * periods**2, pentol=1e-10, maxiter=1000
    )
    assert result.success, result.message
    gap = system.compute_gap(system.disp, system.offset)
    return (system.force > 0).mean(), gap.mean(), system.disp.mean()


one, four = contact(1), contact(2)
for name, values in [("one period", one), ("2 x 2", four)]:
    print("{}: area {:.4f}, mean gap {:.4f}, mean displacement {:.4f}".format(name, *values))
assert np.allclose(one[:2], four[:2], rtol=1e-3), "area and gap depend on the domain, too"
assert np.isclose(one[2], pressure / np.pi), "another mean displacement"
assert np.isclose(four[2], 2 * one[2]), "the displacement does not grow with the domain any more"
PYTHON
