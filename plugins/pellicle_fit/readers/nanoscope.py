r"""Force curves of Bruker's NanoScope, such as ``curve.000`` or ``curve.spm``.

A header of lines ``\key: value`` in sections ``\*name`` states where the integers of each channel
stand. A number such as ``V [Sens. DeflSens] (0.000375 V/LSB) 2.5 V`` has the volts of a step, and
the name of the sensitivity. Rows of the approach are stored from contact on, as are those of the
retraction.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from pellicle.arrays import Array
from pellicle_fit.files.measurement import CurvesByLabel, Measurement
from pellicle_fit.files.reader import (
    DRIVEN,
    Calibration,
    Reader,
    curve_of,
    sections_of,
    unreadable_error,
)

_MARK, _END = rb"\*Force file list", rb"\*File list end"
_LONGEST = 1 << 20
_MISSING = -(2**15), -(2**31)
"""Integers of rows that were not measured."""
_SECTION = re.compile(r"^\\\*(.+)$", re.MULTILINE)
_ENTRY = re.compile(r"^\\(?:@(?:\d:)?)?(.+?):(?: (.*))?$", re.MULTILINE)
"""A key, without the number of its group, and a value."""
_SCALE = re.compile(r"V \[(Sens\. \w+)\] \(([-+.\deE]+) V/LSB\)\s*([-+.\deE]+) V")
_SENSITIVITY = re.compile(r"V\s+([-+.\deE]+)\s*(\S*)")
Section = Mapping[str, str]


class NanoScope(Reader, title="Bruker NanoScope"):
    """Single force curves of Bruker's NanoScope; force volumes are not read."""

    type: Literal["nanoscope"] = "nanoscope"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = (".spm", ".pfc", ".[0-9][0-9][0-9]")

    def sniff(self, path: Path) -> bool:
        """Return whether a file is not one of images."""
        with path.open("rb") as file:
            return file.read(len(_MARK)) == _MARK

    def read(self, path: Path, calibration: Calibration) -> CurvesByLabel:
        """Return what reads the only curve."""
        return {"": partial(_curve, path, calibration)}


def _curve(path: Path, calibration: Calibration) -> Measurement:
    try:
        sections = _sections(path)
        known = {name: value for _, section in sections for name, value in section.items()}
        if (context := sections[0][1]["Start context"]) != "FOL":
            raise ValueError(
                f"start context {context}: of NanoScope, single curves are read; export force "
                "volumes as curves or as text"
            )
        channels = {
            section["Image Data"].split('"')[1]: section
            for name, section in sections
            if name == "Ciao force image list" and '"' in section.get("Image Data", "")
        }
        bend = channels["Deflection Error"]
        rows = _rows(path, bend)
        slope, sensitivity = _scale(bend["Z scale"], known)
        ramp = float(_match(_SCALE, _either(bend, "Ramp size", "Ramp Size"))[3])
        sensor = channels.get("Height Sensor")
        messages = () if sensor or known.get("Z Closed Loop") == "On" else (DRIVEN,)
        if sensor:
            heights, (step, extent) = _rows(path, sensor), _scale(sensor["Z scale"], known)
            place = [step * extent * values for values in heights]
        else:
            _, extent = _scale(_either(bend, "Ramp size", "Ramp Size"), known)
            place = [ramp * extent * np.linspace(1, 0, values.size) for values in rows]
        times = [ramp / float(known[f"{way} vel."]) for way in ("Forward", "Reverse")]
        stiffness = float(_either(bend, "Spring Constant", "Spring constant"))
    except (OSError, ValueError, LookupError, OverflowError) as error:
        raise unreadable_error(path, "a force curve of NanoScope", error) from None
    spans = [np.arange(v.size) / v.size * time for v, time in zip(rows, times, strict=True)]
    volts = np.append(rows[0][::-1], rows[1]) * slope
    exists = ~np.isin(np.append(rows[0][::-1], rows[1]), _MISSING)
    columns = {
        "extension": (np.append(place[0][::-1], place[1])[exists], "m"),
        "deflection": (volts[exists], "V"),
    }
    if all(np.isfinite(time) and time > 0 for time in times):
        columns["time"] = np.append(spans[0], times[0] + spans[1])[exists], "s"
    return curve_of(
        path,
        columns,
        calibration,
        sensitivity=sensitivity,
        spring_constant=stiffness or None,
        messages=messages,
    )


def _sections(path: Path) -> list[tuple[str, Section]]:
    """Return the sections of a header with their names, which may be the same."""
    _, sections = sections_of(path, _SECTION, _END, _LONGEST)
    return [(name, dict(_ENTRY.findall(text))) for name, text in sections]


def _rows(path: Path, channel: Section) -> tuple[Array, Array]:
    """Return the integers of the approach and of the retraction, each from contact on."""
    back, there = (int(text) for text in channel["Samps/line"].split())
    offset, length = int(channel["Data offset"]), int(channel["Data length"])
    size = length // max(back + there, 1)
    if min(back, there) < 1 or size not in (2, 4) or length != size * (back + there):
        raise ValueError(
            f"{length} bytes for {there} rows there and {back} back; curves with a hold are not "
            "read: export them as text"
        )
    if offset < 0 or path.stat().st_size < offset + length:
        raise ValueError(
            f"it ends within its data: {path.stat().st_size} of {offset + length} bytes"
        )
    values = np.fromfile(path, f"<i{size}", there + back, offset=offset).astype(float)
    return values[:there], values[there:]


def _scale(text: str, known: Section) -> tuple[float, float]:
    """Return the volts of a step of integers, and the sensitivity [m/V] that is named with it."""
    scale = _match(_SCALE, text)
    sensitivity = _match(_SENSITIVITY, known[scale[1]])
    if sensitivity[2] not in ("nm/V", ""):
        raise ValueError(f"{scale[1]} is in {sensitivity[2]}, not in nm/V")
    return float(scale[2]), float(sensitivity[1]) * 1e-9


def _match(pattern: re.Pattern[str], text: str) -> re.Match[str]:
    match = pattern.match(text)
    if match is None:
        raise ValueError(f"{text[:60]!r} has no scale")
    return match


def _either(section: Section, *names: str) -> str:
    """Return the value of the first of some names, whose spelling differs between versions."""
    return section[next((name for name in names if name in section), names[0])]
