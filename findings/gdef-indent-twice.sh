#!/usr/bin/env bash
# Guess: the table of GDEFIndentAnalyzer (GDEFReader) gives area and volume of an indent, whether
#   and how often its map has been drawn before.
# Version: GDEFReader 0.0.1a41
# Behaviour: the drawing collects the points of the indent, and collects them again each time. The
#   area is 0 before the first map, right after it, double after the second, for a map in another
#   style, say. Depth and radius stay.
# Output seen: cone of 100 nm depth, 1.8e-13 m^2 above the limit: not drawn 0, drawn once 1.75e-13,
#   twice 3.50e-13 m^2
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check GDEFReader==0.0.1a41 \
    python-pptx-interface==0.0.14 numpy==2.2.6 scipy==1.17.1 matplotlib==3.10.8
cd "$folder"
MPLBACKEND=agg "$folder/venv/bin/python" -W ignore - << 'PYTHON'
import matplotlib.pyplot as plt
import numpy as np
from afm_tools.gdef_indent_analyzer import GDEFIndentAnalyzer
from gdef_reader.gdef_measurement import GDEFMeasurement

count, pixel = 100, 20e-9
measurement = GDEFMeasurement()
settings = measurement.settings
settings._pixel_width = settings._pixel_height = pixel  # as its importer sets them
settings.max_width = settings.max_height = count * pixel
settings.lines, settings.columns, settings.missing_lines = count, count, 0
y, x = (np.mgrid[:count, :count] - count / 2) * pixel
depth, radius = 100e-9, 250e-9
measurement.values = -np.clip(depth * (1 - np.hypot(x, y) / radius), 0, None)

analyzer = GDEFIndentAnalyzer(measurement)
axes = plt.subplots()[1]


def area():
    return float(dict(analyzer.get_summary_table_data())["indent area [m^2]"])


areas = [area()]
for _ in range(2):
    analyzer.add_map_with_indent_pile_up_mask_to_axes(axes)
    areas.append(area())
true = np.pi * (0.95 * radius) ** 2  # below 5 % of the depth
print(f"not drawn {areas[0]}, drawn once {areas[1]}, twice {areas[2]} m^2 (true {true:.2e})")
assert areas[0] == 0, "it is known before it is drawn now"
assert np.isclose(areas[1], true, rtol=0.03), "another area after one map"
assert np.isclose(areas[2], 2 * areas[1], rtol=0.01), "another area after two maps"
PYTHON
