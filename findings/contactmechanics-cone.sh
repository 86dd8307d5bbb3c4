#!/usr/bin/env bash
# Guess: contact_radius_and_area of the cone in ContactMechanics gives the radius over the
#   indentation and the area over its square, so area = pi radius^2.
# Version: ContactMechanics 1.8.3
# Behaviour: the area is pi times the radius, not its square. It is right for the one cone with a
#   radius equal to its depth; for a blunt one, 5.7 degrees from the surface, it is 6.4 times too
#   small, and so is the load that load_and_mean_pressure gives per area. The radius is right.
# Output seen: half angle 45 degrees: radius 0.637, area 2.000 (pi radius^2 1.273); 84.3 degrees:
#   6.366, 20.00 (127.3)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    ContactMechanics==1.8.3 SurfaceTopography==1.27.1 numpy==2.4.6 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from ContactMechanics.ReferenceSolutions import Cone

for half_angle in (np.pi / 4, np.arctan(10)):
    radius, area = Cone.contact_radius_and_area(half_angle)
    true = np.pi * radius**2
    print(f"half angle {np.degrees(half_angle):.1f} degrees: radius {radius:.3f}, area {area:.4g} "
          f"(pi radius^2 {true:.4g})")
    # Sneddon: indentation = pi/2 a cot(half angle)
    assert np.isclose(radius, 2 / np.pi * np.tan(half_angle)), "the radius is wrong, too"
    assert np.isclose(area, np.pi * radius), "the area is another one now"
    assert not np.isclose(area, true, rtol=0.3), "the area is right now"
PYTHON
