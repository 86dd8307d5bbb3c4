#!/usr/bin/env bash
# Guess: the height of a NanoScope curve is that of its height sensor, if the file has the channel.
# Version: pyfmreader 0.1.3
# Behaviour: the height is even steps of the ramp to which the piezo was driven; the channel is not
#   read, whatever it holds. In public curves without a closed loop the sensor goes 19 % further in
#   and 11 % further out than the ramp (1000 nm), and not evenly. Here it goes 1.2 times as far in
#   and 1.1 times as far out: both heights are those of the ramp. Deflections are right.
# Output seen: ramp 1000 nm; sensor 1200 and 1100 nm; height 998 and 998 nm; bent by 50 and 50 nm
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pyfmreader==0.1.3 numpy==2.4.6
cd "$folder"
"$folder/venv/bin/python" - << 'PYTHON'
import numpy as np
from pyfmreader import loadfile

rows, start, step = 500, 8192, 2e-4
ramp, sensed = 1000.0, (1200.0, 1100.0)  # nm, of both passes
share = np.linspace(0, 1, rows)  # rows of both passes are stored from contact on
volts = [1.0 + 2.5 * np.clip(1 - 5 * share, 0, 1)] * 2  # 20 nm/V
sensor = [(extent - extent * share) / 100 for extent in sensed]  # 100 nm/V
channels = {"Sens. DeflSens": ("DeflectionError", "Deflection Error", volts),
            "Sens. ZsensSens": ("ZSensor", "Height Sensor", sensor)}  # fmt: skip
ramped = f"V [Sens. Zsens] (0.0005 V/LSB) {ramp / 100} V"
head = ["*Force file list", "Version: 0x09010300", "Start context: FOL", "*Scanner list",
        "@Sens. Zsens: V 100.0 nm/V", "*Ciao scan list", "Operating mode: Force",
        "@Sens. DeflSens: V 20.0 nm/V", "@Sens. ZsensSens: V 100.0 nm/V", "Z Closed Loop: Off",
        "PeakForce Capture: Disable", "PFT Freq: 2.0 KHz", "Peak Force Amplitude: 150",
        "Sample Points: 256", "Sync Distance QNM: 0", "*Ciao force list", "force/line: 1",
        "Trigger mode: Off", "Scan rate: 5.0", "Forward vel.: 10.0", "Reverse vel.: 10.0",
        f"@4:Trig Threshold Deflection: V [Sens. DeflSens] ({step:.6f} V/LSB) 1.0 V",
        f"Samps/line: {rows} {rows}"]  # fmt: skip
data = b""
for sense, (name, title, passes) in channels.items():
    raw = np.round(np.concatenate(passes) / step * (1 if sense == "Sens. DeflSens" else 0.1))
    scale = step if sense == "Sens. DeflSens" else 10 * step
    head += ["*Ciao force image list", f"Data offset: {start + len(data)}",
             f"Data length: {4 * rows}", "Bytes/pixel: 2", f"Samps/line: {rows} {rows}",
             "Spring Constant: 0.5", f'@4:Image Data: S [{name}] "{title}"',
             f"@4:Z scale: V [{sense}] ({scale:.6f} V/LSB) 20.0 V",
             f"@4:Ramp size: {ramped}"]  # fmt: skip
    data += raw.astype("<i2").tobytes()
head.append("*File list end")
text = "".join(f"\\{line}\r\n" for line in head).encode("latin-1")
with open("curve.spm", "wb") as file:
    file.write(text.ljust(start, b"\0") + data)
content = loadfile("curve.spm")
curve = content.getcurve(0)
curve.preprocess_force_curve(20e-9, content.filemetadata["height_channel_key"])
segments = [segment for _, segment in curve.get_segments()]
height = [1e9 * float(np.ptp(segment.zheight)) for segment in segments]
bent = [1e9 * float(np.ptp(segment.vdeflection)) for segment in segments]
print(f"ramp {ramp:.0f} nm; sensor {sensed[0]:.0f} and {sensed[1]:.0f} nm; "
      f"height {height[0]:.0f} and {height[1]:.0f} nm; "
      f"bent by {bent[0]:.0f} and {bent[1]:.0f} nm")  # fmt: skip
assert np.allclose(bent, 50, rtol=0.01), "the deflection is wrong, too"
assert not np.allclose(height, sensed, rtol=0.01), "the height is that of the sensor now"
assert np.allclose(height, ramp, rtol=0.01), "the height is neither ramp nor sensor"
PYTHON
