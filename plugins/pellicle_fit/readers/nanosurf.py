"""Force spectroscopy of Nanosurf, ``.nid``.

A header of sections with keys ends with ``#!``; the channels follow, each a matrix of integers with
a line for each curve. Lines of the way back are stored from far to near, as those of the way there.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import ClassVar, Literal, NamedTuple

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle_fit.files.measurement import CurvesByLabel, Measurement
from pellicle_fit.files.reader import (
    DRIVEN,
    Calibration,
    Reader,
    curve_of,
    sections_of,
    unreadable_error,
)

_END = b"\r\n#!"
_LONGEST = 1 << 26
"""Bytes in which a header ends; each line of a map adds a hundred."""
_FORWARD, _PAUSE, _BACKWARD = _FRAMES = "Spec forward", "Spec fwd pause", "Spec backward"
_SENSOR = "Z-Axis Sensor"
_SECTION = re.compile(r"^\[(.+)\]$", re.MULTILINE)
_NUMBER = re.compile(r"[DL]\[(.+)\]\*\[(.*)\]")
Sections = Mapping[str, Mapping[str, str]]


class Channel(NamedTuple):
    """A matrix of integers in a file: ``size`` rows of each of some lines, from an offset on."""

    offset: int
    size: int
    bits: int
    head: Mapping[str, str]

    def line(self, path: Path, number: int) -> Array:
        """Return the values of a line; those that were not measured are left out."""
        count = int(self.head.get(f"LineDim{number}Points", self.size))
        if not 0 <= count <= self.size:
            raise ValueError(f"{count} points in line {number} of {self.size}")
        place = self.offset + number * self.size * self.bits // 8
        raw = np.fromfile(path, f"<i{self.bits // 8}", count, offset=place)
        low, span = (float(self.head[f"Dim2{name}"]) for name in ("Min", "Range"))
        values: Array = low + span * (raw / 2.0**self.bits + 0.5)
        return values


class Nanosurf(Reader, title="Nanosurf"):
    """Force spectroscopy of Nanosurf, as its software saves it."""

    type: Literal["nanosurf"] = "nanosurf"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = (".nid",)

    def sniff(self, path: Path) -> bool:
        """Return whether a file has spectra; those of images and sweeps have none."""
        with path.open("rb") as file:
            beginning = file.read(_LONGEST if path.stat().st_size < _LONGEST else 1 << 20)
        return beginning.startswith(b"[DataSet]") and _FORWARD.encode() in beginning

    def read(self, path: Path, calibration: Calibration) -> CurvesByLabel:
        """Return what reads each curve by its number, from 0."""
        try:
            sections, channels = _content(path)
            forward = channels[_FORWARD]["Deflection"]
            count = int(forward.head["Lines"])
            done = min(count, int(forward.head.get("CurLine", count - 1)) + 1)
            if done < 1:
                raise ValueError("no finished curve")
        except (OSError, ValueError, LookupError, OverflowError) as error:
            raise unreadable_error(path, "a spectrum of Nanosurf", error) from None
        read = partial(_curve, path, sections, channels, calibration)
        return {str(n) if done > 1 else "": partial(read, n) for n in range(done)}


def _content(path: Path) -> tuple[Sections, dict[str, dict[str, Channel]]]:
    """Return the sections of a header, and the channels of each frame by what they measure."""
    end, texts = sections_of(path, _SECTION, _END, _LONGEST)
    sections = {
        name: dict(line.split("=", 1) for line in text.splitlines() if "=" in line)
        for name, text in texts
    }
    offset, size, channels = end + len(_END), path.stat().st_size, dict[str, dict[str, Channel]]()
    groups = sections["DataSet"]
    for group in range(int(groups["GroupCount"])):
        # The keys of a group's channels have gaps.
        named = (groups.get(f"Gr{group}-Ch{k}") for k in range(int(groups[f"Gr{group}-Count"])))
        for name in filter(None, named):
            head = sections[name]
            points, lines, bits = (int(head[key]) for key in ("Points", "Lines", "SaveBits"))
            layout = head["SaveMode"], head["SaveSign"], head["SaveOrder"]
            if layout != ("Binary", "Signed", "Intel") or bits not in (8, 16, 32):
                raise ValueError(f"channel {name} has the layout {', '.join(layout)}, {bits} bits")
            channel = Channel(offset, points, bits, head)
            channels.setdefault(head["Frame"], {})[head.get("Dim2Name", "")] = channel
            offset += points * lines * bits // 8
            if min(points, lines) < 1 or offset > size:
                raise ValueError(f"it ends within channel {name}: {size} of {offset} bytes")
    return sections, channels


def _curve(
    path: Path,
    sections: Sections,
    channels: Mapping[str, Mapping[str, Channel]],
    calibration: Calibration,
    number: int,
) -> Measurement:
    """Return a curve: the way there, the pause and the way back, as far as they are in the file."""
    try:
        options = sections.get(r"DataSet\Parameters\Spectroscopy", {})
        signal, place, time, pause = list[Array](), list[Array](), list[Array](), list[Mask]()
        first, began = channels[_FORWARD]["Deflection"].head, 0.0
        unit, axis = first["Dim2Unit"], first.get("Dim0Name", "")
        for frame, key in zip(_FRAMES, ("FwMod", "FwPause", "BwMod"), strict=True):
            if "Deflection" not in channels.get(frame, {}):
                continue
            measured = channels[frame]
            order = slice(None, None, -1 if frame == _BACKWARD else 1)
            signal.append(measured["Deflection"].line(path, number)[order])
            if measured["Deflection"].head["Dim2Unit"] != unit:
                raise ValueError(f"{frame} is not in {unit}")
            place.append(_place(path, measured, axis, number)[order])
            count = signal[-1].size
            step = _number(options, f"{key}Time") / _number(options, f"{key}Datapoints")
            ended = began + step * count
            time.append(np.linspace(began, ended, count, endpoint=False))
            began = ended
            pause.append(np.full(count, frame == _PAUSE))
        is_measured = all(_SENSOR in channels[frame] for frame in _FRAMES if frame in channels)
        stiffness = _number(sections.get(r"DataSet\Calibration\Cantilever", {}), "Prop0")
    except (OSError, ValueError, LookupError, OverflowError) as error:
        raise unreadable_error(path, "a spectrum of Nanosurf", error) from None
    role = "force" if unit == "N" else "deflection"
    columns = {
        "extension": (np.concatenate(place), "m"),
        role: (np.concatenate(signal), unit),
    }
    if np.isfinite(began):
        columns["time"] = np.concatenate(time), "s"
    is_pause = np.concatenate(pause)
    return curve_of(
        path,
        columns,
        calibration,
        spring_constant=stiffness if stiffness > 0 else None,
        pause=is_pause if is_pause.any() else None,
        messages=() if is_measured else (DRIVEN,),
    )


def _place(path: Path, measured: Mapping[str, Channel], axis: str, number: int) -> Array:
    """Return the place of the base [m] in a line: that of its sensor, or else as it was driven."""
    head = measured["Deflection"].head
    channel = measured.get(_SENSOR) or measured.get(axis)
    if channel is None:
        count = measured["Deflection"].line(path, number).size
        line = f"LineDim{number}" if f"LineDim{number}Min" in head else "Dim0"
        if head["Dim0Unit"] != "m":
            raise ValueError(f"its axis is {head['Dim0Name']}, in {head['Dim0Unit']}")
        low, span = (float(head[f"{line}{name}"]) for name in ("Min", "Range"))
        driven: Array = np.linspace(low, low + span, count)
        return driven
    if channel.head["Dim2Unit"] != "m":
        raise ValueError(f"its place is in {channel.head['Dim2Unit']}")
    return channel.line(path, number)


def _number(section: Mapping[str, str], key: str) -> float:
    """Return a number of a section, such as ``D[0.2]*[N/m]``; NaN for none or 0."""
    match = _NUMBER.fullmatch(section.get(key, ""))
    return (float(match[1]) or np.nan) if match else np.nan
