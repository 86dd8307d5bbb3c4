#!/usr/bin/env bash
# Guess: get_fft_frequency of afmmech gives the frequencies of get_fft, zero among them.
# Version: afmmech 4.2, igor 0.3
# Behaviour: it spreads them evenly from minus to plus half the sampling rate, both ends included.
#   For an even number of rows none is zero and all are off, from half a step at zero to a whole
#   one at the end. In a short record a sine of 100 Hz is found at 106 Hz, and a modulus is told
#   for the wrong frequency.
# Output seen: 100 rows: sine of 100 Hz at 106.1 Hz, least frequency 5.1 Hz; 1000 rows: 100.6 and
#   0.5 Hz
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    afmmech==4.2 igor==0.3 numpy==2.4.6 \
    scipy==1.17.1 pandas==3.1.1 matplotlib==3.11.2 tqdm==4.70.1 joblib==1.6.0
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np

np.complex = complex  # igor 0.3, which afmmech imports, is older than numpy 1.24
from afmmech import helpers  # noqa: E402

rate = 1000.0
for rows in (100, 1000):
    wave = np.sin(2 * np.pi * 100 * np.arange(rows) / rate)
    amplitudes = abs(helpers.get_fft(wave))
    named = helpers.get_fft_frequency(wave, rate)
    true = np.fft.fftshift(np.fft.fftfreq(rows, 1 / rate))
    found, right = (axis[axis > 0][np.argmax(amplitudes[axis > 0])] for axis in (named, true))
    least = np.min(abs(named))
    print(f"{rows} rows: sine of 100 Hz at {found:.1f} Hz, least frequency {least:.1f} Hz")
    assert np.isclose(right, 100), "the transform is wrong, too"
    assert np.isclose(least, rate / 2 / (rows - 1)), "zero is among the frequencies now"
    assert found - 100 > 0.5 * rate / rows, "the frequency is right now"
PYTHON
