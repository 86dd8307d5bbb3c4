#!/usr/bin/env bash
# Guess: import_rheo_data of rheodata returns all tests of a workbook that an Anton Paar rheometer
#   exported, and of each all intervals as numbers.
# Version: rheodata 0.0.8 (without the dependencies that this part does not need)
# Behaviour: tests are kept by name. Two of one name, as a sweep that was repeated has, are one: the
#   last, the others are dropped without a word (test_names has them all). Of a test with two
#   intervals the lines of text between them are rows of data, the number of the interval in the
#   column of the point.
# Output seen: 3 tests in the file, 2 returned; of "sweep" 300 400 Pa, the second one; of 4 points
#   in two intervals 10 rows
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 openpyxl==3.1.5
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps rheodata==0.0.8
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import pandas as pd
from rheodata.extractors.antonpaar import AntonPaarExtractor


def write(name, *intervals):
    rows = [["Test:", name]]
    for number, moduli in enumerate(intervals, start=1):
        rows += [
            ["Result:", f"{name} {number}"],
            ["Interval and data points:", number, len(moduli)],
            ["Interval data:", "Point No.", "Angular Frequency", "Storage Modulus"],
            [None],
            [None, None, "[rad/s]", "[Pa]"],
            *([None, point + 1, 10.0**point, modulus] for point, modulus in enumerate(moduli)),
            [None],
        ]
    return rows


tests = [write("sweep", [100, 200]), write("sweep", [300, 400]), write("two", [1, 2], [3, 4])]
rows = [["Project:", "gel"], [None]] + [row for test in tests for row in test]
pd.DataFrame(rows).to_excel("export.xlsx", header=False, index=False)
extractor = AntonPaarExtractor()
found, *_ = extractor.import_rheo_data("export.xlsx")
sweep, two = [float(value) for value in found["sweep"].iloc[:2, 2]], found["two"]
print(f"{len(tests)} tests in the file, {len(found)} returned; sweep:", *sweep, "Pa;",
      f"{len(two)} rows of 4 points")
assert extractor.test_names == ["sweep", "sweep", "two"], "other tests are seen"
assert list(found) == ["sweep", "two"] and sweep == [300, 400], "the first sweep is kept now"
assert len(two) == 10 and "Point No." in list(two.iloc[:, 0]), "intervals are told apart now"
PYTHON
