#!/usr/bin/env bash
# Guess: a segment of pyfmreader without a column of times gets them from its sampling rate in Hz:
#   the step is one over the rate.
# Version: pyfmreader 0.1.3
# Behaviour: the duration is the number of rows times the rate, so the step is the rate itself: 500
#   rows at 1000 Hz last 500 000 s instead of half a second. Speeds and relaxation times are off by
#   the square of the rate; at 1 Hz it is right. With a column of times it is right, too.
# Output seen: 500 rows at 1000 Hz: step 1000.0 s; with a column of times 0.001 s
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pyfmreader==0.1.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from pyfmreader.load_uff import loadUFFcurve, loadUFFheader

rows, rate = 500, 1000.0
time, height = np.arange(rows) / rate, np.linspace(2e-6, 0, rows)


def load(columns):
    """A curve of one segment in the text form of the Universal File Format."""
    part = "HE Recording_segment_0_"
    lines = ["HE Recording_curve_id: 0", "HE Entry_filename: curve",
             "HE Recording_number_segment: 1", f"{part}type: Approach", f"{part}code: AP",
             f"{part}nb_point: {rows}", f"{part}nb_col: {len(columns)}",
             f"{part}force_setpoint_mode: 0", f"{part}force_setpoint(N): 0",
             f"{part}velocity(m/s): 4E-6", f"{part}sampling_rate(Hz): {rate}",
             f"{part}z_displacement(m): 2E-6"]  # fmt: skip
    lines += [f"{part}col_{k}_title: {name}" for k, name in enumerate(columns)]
    for values in zip(*columns.values()):
        lines.append("AP 0 " + " ".join(f"{value:.6E}" for value in values))
    with open("curve.uff", "w") as file:
        file.write("\n".join(lines) + "\n")
    curve = loadUFFcurve(loadUFFheader("curve.uff"))
    curve.preprocess_force_curve(1e-7, "height")
    return curve.extend_segments[0][1]


columns = {"height": height, "vDeflection": 0 * height}
without, beside = load(columns), load({**columns, "time": time})
steps = [segment.time[1] - segment.time[0] for segment in (without, beside)]
print(f"{rows} rows at {without.sampling_rate:.0f} Hz: step {steps[0]:.1f} s, "
      f"with a column of times {steps[1]:.3f} s")
assert without.sampling_rate == rate, "another sampling rate"
assert np.isclose(steps[1], 1 / rate), "a column of times is wrong, too"
assert np.isclose(steps[0], rate), "the step is another one now"
PYTHON
