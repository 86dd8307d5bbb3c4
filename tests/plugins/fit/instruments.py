"""Writes small files in the formats of instruments, to be read back.

Each writer takes a `Recording`, what a microscope sees of an approach and a retract.
"""

import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array


@dataclass(frozen=True)
class Recording:
    """Height of the cantilever's base [m], falling and rising again, and force [N]."""

    height: Array
    force: Array
    spring_constant: float
    sensitivity: float = 50e-9
    place: tuple[float | str, float | str] | None = None
    """Where on the sample it was measured [m]."""
    segments: Mapping[str, int] = field(default_factory=dict)
    """Number of rows by the style of each segment; empty for halves that extend and retract."""

    @property
    def styles(self) -> tuple[str, ...]:
        """What the cantilever does in each segment."""
        return (*self.segments,) or ("extend", "retract")

    @property
    def segment(self) -> NDArray[np.uint8]:
        """Number of the segment of each row, from 0."""
        half = self.force.size // 2
        sizes = (*self.segments.values(),) or (half, self.force.size - half)
        return np.repeat(np.arange(len(sizes), dtype=np.uint8), sizes)

    @property
    def volts(self) -> Array:
        """Signal of the detector."""
        return self.force / self.spring_constant / self.sensitivity


_MODES = {2: "force-distance", 3: "creep-compliance", 4: "stress-relaxation"}
"""What is measured, by the number of segments."""


def record(position: Array, force: Array, noise: Array, spring_constant: float) -> Recording:
    """Return what is seen of a curve, and of the way back with some adhesion.

    Position and force are those of the tip; the noise [N] is that of the deflection.
    """
    both = np.concatenate([force, force[::-1] - 0.1 * force.max()])
    tip = -np.concatenate([position, position[::-1]])
    seen = both + np.concatenate([noise, noise[::-1]])
    return Recording(tip - both / spring_constant, seen, spring_constant)


def hdf5(path: Path, *recordings: Recording) -> None:
    """Write what afmformats exports."""
    import h5py

    with h5py.File(path, "w") as file:
        for number, recording in enumerate(recordings):
            _exported(path, recording, number).export_data(file, fmt="hdf5")


def tab(path: Path, recording: Recording) -> None:
    """Write what afmformats exports."""
    # Its file is in the encoding of the machine otherwise.
    with path.open("w", encoding="utf-8", newline="") as file:
        _exported(path, recording, 0).export_data(file, fmt="tab")


def _exported(path: Path, recording: Recording, number: int):  # type: ignore[no-untyped-def]
    from afmformats.mod_force_distance import AFMForceDistance

    data = {
        "force": recording.force,
        "height (measured)": recording.height,
        "segment": recording.segment,
    }
    metadata = {
        "imaging mode": _MODES[len(recording.styles)],
        "spring constant": recording.spring_constant,
        "enum": number,
        "path": path,
    }
    if recording.place is not None:
        metadata |= dict(zip(("position x", "position y"), recording.place, strict=True))
    return AFMForceDistance(data, metadata)


def jpk(path: Path, *recordings: Recording, styles: Sequence[str] = ()) -> None:
    """Write a JPK archive: properties, and channels of big-endian integers; several make a map."""
    with zipfile.ZipFile(path, "w") as archive:
        general = "file-format-version=0.5\n"
        if len(recordings) > 1:
            archive.writestr("header.properties", general)
            archive.writestr("index/", "")
        for number, recording in enumerate(recordings):
            folder = f"index/{number}/" if len(recordings) > 1 else ""
            if folder:
                archive.writestr(folder, "")
            archive.writestr(f"{folder}header.properties", general)
            archive.writestr(f"{folder}segments/", "")
            for segment, style in enumerate(styles or recording.styles):
                inner = f"{folder}segments/{segment}/"
                rows = recording.segment == segment
                archive.writestr(inner, "")
                archive.writestr(
                    f"{inner}segment-header.properties", _jpk_header(recording, rows, style, number)
                )
                for name, values in (
                    ("measuredHeight", recording.height),
                    ("vDeflection", recording.volts),
                ):
                    whole = np.round(values[rows] / _jpk_step(values)).astype(">i4")
                    archive.writestr(f"{inner}channels/{name}.dat", whole.tobytes())


def _jpk_step(values: Array) -> float:
    return float(np.abs(values).max(initial=1e-30)) / 2**30


def _jpk_header(recording: Recording, rows: NDArray[np.bool_], style: str, number: int) -> str:
    settings = "force-segment-header.settings"
    lines = [
        f"force-segment-header.num-points={rows.sum()}",
        "force-segment-header.duration=1.0",
        "force-segment-header.approach-id=1",
        "force-segment-header.time-stamp=2026-01-02 10:11:12 +0000",
        f"force-scan-map.header.position-index={number}",
        f"{settings}.style={style.split()[-1]}",
        f"{settings}.segment-settings.type={style.replace(' ', '-')}",
        f"{settings}.feedback-mode.name=contact",
        f"{settings}.segment-settings.duration=1.0",
        f"{settings}.segment-settings.z-start=1e-5",
        f"{settings}.segment-settings.z-end=0.0",
    ]
    for axis, place in zip("xy", recording.place or (), strict=False):
        lines.append(f"force-scan-map.header.position.{axis}={place!r}")
    for name, values, base, steps in (
        ("measuredHeight", recording.height, "nominal", {}),
        (
            "vDeflection",
            recording.volts,
            "volts",
            {
                "distance": ("volts", recording.sensitivity, "m"),
                "force": ("distance", recording.spring_constant, "N"),
            },
        ),
    ):
        channel = f"channel.{name}"
        unit = "m" if base == "nominal" else "V"
        lines += [
            f"{channel}.data.encoder.type=signedinteger",
            f"{channel}.data.encoder.scaling.offset=0.0",
            f"{channel}.data.encoder.scaling.multiplier={_jpk_step(values)!r}",
            f"{channel}.data.encoder.scaling.unit.unit={unit}",
            f"{channel}.conversion-set.conversions.base={base}",
            f"{channel}.conversion-set.conversion.{base}.name={base}",
        ]
        for slot, (of, multiplier, unit) in steps.items():
            conversion = f"{channel}.conversion-set.conversion.{slot}"
            lines += [
                f"{conversion}.name={slot}",
                f"{conversion}.base-calibration-slot={of}",
                f"{conversion}.scaling.offset=0.0",
                f"{conversion}.scaling.multiplier={multiplier!r}",
                f"{conversion}.scaling.unit.unit={unit}",
            ]
    return "\n".join(lines) + "\n"


def workshop(path: Path, recording: Recording) -> None:
    """Write an AFM Workshop table, in volts."""
    half = recording.force.size // 2
    nm = -1e9 * recording.height
    columns = (nm[:half], recording.volts[:half], nm[half:], recording.volts[half:])
    lines = [
        "Force-Distance Curve",
        "File Format:\t3",
        "",
        "Date:\tWednesday, August 1, 2018",
        "Time:\t1:07:47 PM",
        "Mode:\tSingle",
        "Point:\t1",
        "X, um:\t27.250000",
        "Y, um:\t27.250000",
        "",
        "Extend Z-Sense(nm),Extend T-B(V),Retract Z-Sense(nm),Retract T-B(V)",
        *(",".join(f"{value:.10g}" for value in row) for row in zip(*columns, strict=True)),
    ]
    path.write_text("\n".join(lines), encoding="utf-8")


def chiaro(path: Path, recording: Recording) -> None:
    """Write a table of an Optics11 Chiaro, which has the position of the tip."""
    bending = recording.force / recording.spring_constant
    piezo = -recording.height
    rows = np.column_stack(
        [
            1e-3 * np.arange(piezo.size),
            1e6 * recording.force,
            1e9 * np.clip(piezo - bending, 0, None),
            1e9 * bending,
            1e9 * piezo,
            0 * piezo,
        ]
    )
    lines = [
        "Date\t12/05/2025\tTime\t11:20:38\tStatus\tOK",
        "Piezo position (nm) (Measured)\t-10.3",
        f"k (N/m)\t{recording.spring_constant}",
        "Device:\tChiaro",
        "Software version: V3.5.0",
        "Max load (µN)\t0.050",
        "Piezo speed  (µm/s)\t7.000",
        "Time (s)\tLoad (uN)\tIndentation (nm)\tCantilever (nm)\tPiezo (nm)\tAuxiliary",
        *("\t".join(f"{value:.10g}" for value in row) for row in rows),
    ]
    path.write_text("\n".join(lines) + "\n", encoding="latin-1")


def jpk_text(path: Path, recording: Recording, signal: str = "N", heights: str = "height") -> None:
    """Write JPK's text export with a signal in N, m or V; the last of ``heights`` is right."""
    bending = recording.force / recording.spring_constant
    values = {"N": recording.force, "m": bending, "V": recording.volts}[signal]
    time, blocks = np.arange(values.size) * 1e-3, []
    for segment, name in enumerate(("extend", "retract")):
        rows = recording.segment == segment
        columns = [0 * time] * heights.count(" ") + [recording.height, values, time]
        blocks += [
            f"# segmentIndex: {segment}",
            f"# segment: {name}",
            f"# columns: {heights} vDeflection seriesTime time",
            f"# sensitivity: {recording.sensitivity}",
            f"# springConstant: {recording.spring_constant}",
            f"# units: {'m ' * len(heights.split())}{signal} s s",
            "#",
            *(
                " ".join(f"{value:.10e}" for value in (*row, row[-1] - time[rows][0]))
                for row in np.column_stack(columns)[rows]
            ),
            "",
        ]
    path.write_text("\n".join(blocks), encoding="utf-8")


def stated(path: Path, recording: Recording) -> None:
    """Write a plain table below a line that states the spring constant."""
    rows = np.column_stack([-1e6 * recording.height, 1e9 * recording.force])
    header = f"Spring constant (pN/nm): {1e3 * recording.spring_constant}\nheight [um],force [nN]"
    rows[:, 0] *= -1
    np.savetxt(path, rows, delimiter=",", header=header, fmt="%.12g")


def archive(
    path: Path, recordings: Sequence[Recording], columns: int = 4, points: Sequence[int] = ()
) -> None:
    """Write a zip of AFM Workshop, in newtons, of places on a grid; and what else may be in one."""
    with zipfile.ZipFile(path, "w") as zipped:
        zipped.writestr("readme.txt", "What the numbers mean, and who measured them")
        zipped.writestr("__MACOSX/._pt1.csv", b"\0\5\26\7")
        for number, recording in enumerate(recordings):
            half = recording.force.size // 2
            nm, nn = -1e9 * recording.height, 1e9 * recording.force
            lines = [
                "Force-Distance Curve",
                "Date:\tWednesday, August 1, 2018",
                "Time:\t1:07:47 PM",
                f"Mode:\t{'Single' if points else 'Mapping'}",
                f"Point:\t{points[number] if points else number + 1}",
                f"X, um:\t{number % columns}",
                f"Y, um:\t{number // columns}",
                "Extend Z-Sense(nm),Extend Force(nN),Retract Z-Sense(nm),Retract Force(nN)",
                *(
                    ",".join(f"{value:.10g}" for value in row)
                    for row in zip(nm[:half], nn[:half], nm[half:], nn[half:], strict=True)
                ),
            ]
            zipped.writestr(f"pt{number + 1}.csv", "\n".join(lines))


def nova(path: Path, recording: Recording, sensitivity: float) -> None:
    """Write an export of NT-MDT's Nova: height [nm] and the signals [nA] on the way in and out."""
    half = recording.force.size // 2
    signal = 1e9 * recording.force / recording.spring_constant / sensitivity
    rows = [1e9 * recording.height[:half], signal[:half], signal[half:][::-1]]
    np.savetxt(path, np.column_stack(rows)[::-1], delimiter="\t", fmt="%.10g")


def nid(path: Path, *recordings: Recording, cut: int = 0, bits: str = "32") -> None:
    """Write what Nanosurf's software saves; the way back is stored from far to near."""
    half = recordings[0].force.size // 2
    channels = {"Deflection": "N", "Z-Axis Sensor": "m"}
    keys, heads, data = [], [], b""
    for group, frame in enumerate(("Spec forward", "Spec backward")):
        keys += [f"Gr{group}-Name={frame}", f"Gr{group}-Count=8"]
        for number, (name, unit) in enumerate(channels.items()):
            values = np.stack([r.force if unit == "N" else -r.height for r in recordings])
            values = values[:, half:][:, ::-1] if group else values[:, :half]
            low, span = float(values.min()), float(np.ptp(values)) * (1 + 1e-9)
            raw = np.floor((values - low) / span * 2**32 - 2**31).clip(-(2**31), 2**31 - 1)
            data += raw.astype("<i4").tobytes()
            keys.append(f"Gr{group}-Ch{7 * number}=DataSet-{group}:{7 * number}")
            heads += [
                f"[DataSet-{group}:{7 * number}]",
                f"Points={values.shape[1]}\nLines={len(recordings)}\nFrame={frame}",
                f"CurLine={len(recordings) - 1}\nDim0Name=Z-Axis\nDim0Unit=m",
                f"Dim2Name={name}\nDim2Unit={unit}\nDim2Range={span!r}\nDim2Min={low!r}",
                f"SaveMode=Binary\nSaveBits={bits}\nSaveSign=Signed\nSaveOrder=Intel",
            ]
    options = [f"{way}Mod{key}" for way in ("Fw", "Bw") for key in ("Time=D[1]*[s]",)]
    options += [f"{way}ModDatapoints=L[{half}]*[]" for way in ("Fw", "Bw")]
    stiffness = f"Prop0=D[{recordings[0].spring_constant}]*[N/m]"
    lines = ["[DataSet]", "GroupCount=2", *keys, r"[DataSet\Parameters\Spectroscopy]", *options]
    lines += [r"[DataSet\Calibration\Cantilever]", stiffness, *heads, "", ""]
    content = "\n".join(lines).replace("\n", "\r\n").encode("latin-1") + b"#!" + data
    path.write_bytes(content[: len(content) - cut])


def nanoscope(path: Path, recording: Recording, context: str = "FOL", samples: int = 0) -> None:
    """Write what NanoScope saves; rows of both passes are stored from contact on."""
    half = recording.force.size // 2
    there = slice(half - 1, None, -1), slice(half, None)
    signals = {
        "DeflSens": ("DeflectionError", "Deflection Error", recording.volts),
        "ZsensSens": ("ZSensor", "Height Sensor", -recording.height / 100e-9),
    }
    images, data = [], b""
    for sense, (name, title, volts) in signals.items():
        step = float(np.abs(volts).max() / 2**30)
        raw = np.round(np.concatenate([volts[of] for of in there]) / step).astype("<i4")
        images += [
            "*Ciao force image list",
            f"Data offset: {4096 + len(data)}",
            f"Data length: {raw.nbytes}",
            "Bytes/pixel: 2",
            f"Samps/line: {half} {half + samples}",
            f"Spring Constant: {recording.spring_constant}",
            f'@4:Image Data: S [{name}] "{title}"',
            f"@4:Z scale: V [Sens. {sense}] ({step!r} V/LSB) 2.5 V",
            "@4:Ramp size: V [Sens. Zsens] (0.0067 V/LSB) 10.0 V",
        ]
        data += raw.tobytes()
    sensitivity = f"@Sens. DeflSens: V {recording.sensitivity * 1e9} nm/V"
    lines = ["*Force file list", f"Start context: {context}", "*Ciao scan list", sensitivity]
    lines += ["@Sens. Zsens: V 100.0 nm/V", "@Sens. ZsensSens: V 100.0 nm/V"]
    lines += ["Forward vel.: 10.0", "Reverse vel.: 10.0", *images, "*File list end"]
    header = "".join(f"\\{line}\r\n" for line in lines).encode("latin-1")
    path.write_bytes(header.ljust(4096, b"\0") + data)


WRITERS: dict[str, Callable[[Path, Recording], None]] = {
    "export.h5": hdf5,
    "export.tab": tab,
    "curve.jpk-force": jpk,
    "workshop.csv": workshop,
    "chiaro.txt": chiaro,
    "export.txt": jpk_text,
    "stated.csv": stated,
    "spectrum.nid": nid,
    "curve.000": nanoscope,
    "curve.spm": nanoscope,
}
"""Files of one curve."""
MAPS: dict[str, Callable[[Path, Sequence[Recording]], None]] = {
    "export.h5": lambda path, recording: hdf5(path, *recording),
    "map.jpk-force-map": lambda path, recording: jpk(path, *recording),
    "map.nid": lambda path, recording: nid(path, *recording),
}
"""Files of several."""
