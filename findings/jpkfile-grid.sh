#!/usr/bin/env bash
# Guess: get_single_pixel((i, j)) of jpkfile, "grid coordinates pointing to desired pixel", reaches
#   each curve of a JPK force map once.
# Version: jpkfile 1.6.1
# Behaviour: the curve's number is taken as ilength i + j, the map's as i + ilength j. A square map
#   comes out mirrored at its diagonal. Of a map of 2 columns and 5 rows three curves come twice and
#   three never, without a word; of one with more columns than rows the last column is missing
#   (KeyError).
# Output seen: 2 x 5, column by column: 0 1 2 3 4, 2 3 4 5 6; of 3 x 3, first row: 0 3 6
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check jpkfile==1.6.1 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" -W ignore - << 'PYTHON'
import struct
import zipfile

from jpkfile import JPKMap

date = "#Mon Jan 01 12:00:00 UTC 2024\n"
pattern = "force-scan-map.position-pattern."
segment = (
    "force-segment-header.duration=1.0\nforce-segment-header.num-points=2\n"
    "channel.height.data.type=short\n"
)


def read(columns, rows):
    """Number of the curve at each place (column, row) of a map that is stored row by row."""
    with zipfile.ZipFile("map.jpk-force-map", "w") as file:
        grid = f"{pattern}grid.ilength={columns}\n{pattern}grid.jlength={rows}\n"
        kind = f"{pattern}type=grid-position-pattern\n"
        file.writestr("header.properties", date + kind + grid)
        for k in range(columns * rows):
            folder = f"index/{k}/"
            file.writestr(f"{folder}header.properties", f"{date}number={k}\n")
            file.writestr(f"{folder}segments/0/segment-header.properties", date + segment)
            points = struct.pack(">2h", k, k)
            file.writestr(f"{folder}segments/0/channels/height.dat", points)
    curves = JPKMap("map.jpk-force-map")
    assert [int(curves.flat_indices[k].parameters["number"]) for k in range(columns * rows)] == [
        *range(columns * rows)
    ], "the curves are mixed up"
    return [
        [int(curves.get_single_pixel((i, j)).parameters["number"]) for j in range(rows)]
        for i in range(columns)
    ]


tall, square = read(2, 5), read(3, 3)
first_row = [column[0] for column in square]
print("2 x 5, column by column:", *tall, "; 3 x 3, first row:", *first_row)
assert tall == [[0, 1, 2, 3, 4], [2, 3, 4, 5, 6]], "other curves of 2 x 5 are reached"
assert first_row == [0, 3, 6], "a square map is not mirrored any more"
PYTHON
