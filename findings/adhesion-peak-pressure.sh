#!/usr/bin/env bash
# Guess: JKR.peak_pressure of Adhesion gives the largest pressure below a sphere; without adhesion
#   that of Hertz, 3 F / (2 pi a^2).
# Version: Adhesion 0.93, ContactMechanics 1.8.3
# Behaviour: it gives a length: the contact radius of the unstable branch. Without adhesion it is
#   the radius of Hertz, whatever the modulus of the pressure; a stiffer solid has a smaller "peak
#   pressure". DMT.radius_and_pressure beside it is right.
# Output seen: F = 1 uN, R = 1 um, E* = 1 MPa, almost no adhesion: JKR 9.085e-07, Hertz 578407 Pa
#   with a radius of 9.086e-07 m; E* = 8 MPa: JKR 4.543e-07, Hertz 2313630 Pa
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    Adhesion==0.93 ContactMechanics==1.8.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from Adhesion.ReferenceSolutions import DMT, JKR
from ContactMechanics.ReferenceSolutions import Hertz

force, radius, adhesion = 1e-6, 1e-6, 1e-9  # N, m, J/m^2: almost none
for modulus in (1e6, 8e6):
    contact, pressure = Hertz.radius_and_pressure(force, radius, modulus)
    peak = JKR.peak_pressure(
        force=force, radius=radius, contact_modulus=modulus, work_of_adhesion=adhesion
    )
    print(f"E* = {modulus:.0e} Pa: JKR {peak:.3e}, Hertz {pressure:.0f} Pa, {contact:.3e} m")
    dmt = DMT.radius_and_pressure(force, radius, modulus, adhesion)[1]
    stable = JKR.contact_radius(
        force=force, radius=radius, contact_modulus=modulus, work_of_adhesion=adhesion
    )
    assert np.isclose(dmt, pressure, rtol=0.02), "DMT is wrong, too"
    assert np.isclose(stable, contact, rtol=0.1), "the contact radius is wrong, too"
    assert np.isclose(peak, contact, rtol=0.1), "it is not the contact radius any more"
PYTHON
