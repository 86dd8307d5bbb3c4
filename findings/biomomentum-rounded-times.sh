#!/usr/bin/env bash
# Guess: FitSinusoid of biomomentum takes oscillations at any sampling rate; 1000 rows a second are
#   better than 100.
# Version: biomomentum 0.1.10
# Behaviour: times are rounded to 10 ms and the data interpolated there, so above 100 Hz a record
#   becomes steps of 10 ms. The amplitude at 40 Hz is 16 % low, at 1 Hz right. Where the last time
#   is rounded up it lies outside of the record: ValueError, for some numbers of rows and not for
#   others.
# Output seen: 1000 rows a second, 12 numbers of rows: 40 Hz: amplitude 0.84 to 0.85, 7 times
#   ValueError; 1 Hz: 1.00, 7 times ValueError
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check biomomentum==0.1.10 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from biomomentum.analysis_dynamic import FitSinusoid

rate, amplitudes, refused = 1000.0, {}, {}
for frequency in (1.0, 40.0):
    found, failures = [], 0
    for rows in range(4000, 4012):
        time = np.arange(rows) / rate
        strain = np.sin(2 * np.pi * frequency * time + 0.3)
        try:
            found.append(float(FitSinusoid(time, frequency, strain)[0][1]))
        except ValueError:
            failures += 1
    amplitudes[frequency], refused[frequency] = (min(found), max(found)), failures
    print(f"{frequency:.0f} Hz: amplitude {min(found):.2f} to {max(found):.2f}, "
          f"{failures} times ValueError of 12")
assert np.allclose(amplitudes[1.0], 1, atol=0.01), "slow oscillations are wrong, too"
assert np.allclose(amplitudes[40.0], 0.845, atol=0.03), "fast oscillations are another now"
assert 0 < refused[1.0] < 12, "the number of rows does not matter any more"
PYTHON
