#!/usr/bin/env bash
# Guess: the methods Talbot ("robust for oscillatory transforms") and DeHoog ("most accurate for
#   difficult transforms") of nilt lose digits slowly on an oscillation that lasts, such as the
#   ringing of an instrument with inertia in a creep test.
# Version: nilt-python 4.0.0
# Behaviour: they are exact to 7 digits or more for some periods and next to zero afterwards: Talbot
#   in the fourth period, DeHoog in the seventh. Nothing is said; what comes out looks like a
#   ringing that has died down.
# Output seen: decay of 10 % per second at 10 rad/s; at 1 s: true -0.0492, Talbot -0.0492, DeHoog
#   -0.0492; at 2 s: 0.0747, 0.0001, 0.0747; at 4 s: 0.0500, 0.0000, 0.0000
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    nilt-python==4.0.0 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import math

import nilt

decay, turn = 0.1, 10.0
ringing = math.sqrt(turn**2 - decay**2)
times, seen = (1.0, 2.0, 4.0), []
for time in times:
    true = math.exp(-decay * time) * math.sin(ringing * time) / ringing
    found = [
        float(nilt.invert(lambda s: 1 / (s * s + 2 * decay * s + turn**2), time, method=method))
        for method in ("Talbot", "DeHoog")
    ]
    print(f"{time:.0f} s: true {true:.4f}, Talbot {found[0]:.4f}, DeHoog {found[1]:.4f}")
    seen.append((true, *found))
(first, *early), (second, *middle), (third, *late) = seen
assert max(abs(value / first - 1) for value in early) < 1e-6, "the first period is wrong, too"
assert abs(middle[1] / second - 1) < 1e-6, "DeHoog is wrong in the fourth period, too"
assert abs(middle[0] / second) < 0.01, "Talbot is not zero in the fourth period any more"
assert max(abs(value / third) for value in late) < 1e-5, "the seventh period is not zero any more"
PYTHON
