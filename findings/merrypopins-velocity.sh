#!/usr/bin/env bash
# Guess: avg_depth_velocity of a pop-in in merrypopins, one of the "shape statistics during the
#   pop-in", is its depth over its duration, which stand beside it (depth_jump, popin_length).
# Version: merrypopins 1.1.2
# Behaviour: "during" lasts half a second longer than the pop-in (after_window, which the
#   documentation has for context after it), so a pop-in of 40 ms is 8 % of it and its velocity is
#   mostly that of the loading that goes on. Mean depth and curvature are diluted likewise. The
#   statistics in stress and strain end with the pop-in. total_popin_duration is from the start of
#   the first pop-in to the end of the last, however short they are.
# Output seen: 40 nm in 0.04 s: 1000 nm/s, avg_depth_velocity 102 nm/s; total duration of two 6.04 s
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check merrypopins==1.1.2 \
    numpy==2.4.6 pandas==3.1.1 scipy==1.17.1 scikit-learn==1.9.1 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" - 2> log.txt << 'PYTHON'
import numpy as np
import pandas as pd
from merrypopins.statistics import calculate_curve_summary, default_statistics

step, starts, rows = 0.01, (300, 900), 1500
time = step * np.arange(rows)
speed = np.full(rows - 1, 30.0)
load = 100 * time
for start in starts:  # four steps of 10 nm, while the load drops a little
    speed[start : start + 4] = 1000.0
    load[start + 1 : start + 4] = load[start] - 0.5
depth = np.concatenate([[0], np.cumsum(speed * step)])
flags = np.isin(np.arange(rows), starts)
curve = pd.DataFrame(
    {"Time (s)": time, "Depth (nm)": depth, "Load (µN)": load, "popin": flags}
)
found = default_statistics(curve)
first = found.loc[starts[0]]
total = calculate_curve_summary(found)["total_popin_duration"]
velocity = first["depth_jump"] / first["popin_length"]
print(f"{first['depth_jump']:.0f} nm in {first['popin_length']:.2f} s: {velocity:.0f} nm/s, "
      f"avg_depth_velocity {first['avg_depth_velocity']:.0f} nm/s; total {total:.2f} s")
assert np.isclose(velocity, 1000), "depth and duration are wrong, too"
assert first["avg_depth_velocity"] < 200, "the velocity is that of the pop-in now"
assert np.isclose(total, (starts[1] - starts[0] + 4) * step), "the total is a sum now"
PYTHON
