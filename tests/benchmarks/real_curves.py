"""Every curve in a folder of measured curves: how it ends, how long it takes, and against nanite.

Run it: ``python tests/benchmarks/real_curves.py FOLDER``.  It prints a row for each file, and one
for each curve whose modulus differs from nanite's by more than 0.1 %, which is not rounding.

Each curve is fitted twice: as a user would, with the tension free; and with the tension fixed at 0
and the position of the tip, which is what nanite's model ``hertz_para`` fits, with all rows equal.
Its rows are then given to nanite.  The test data of nanite and afmformats, unpacked from their
source distributions, are such folders.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

import pellicle as pl
from pellicle.errors import PellicleError
from pellicle_fit.files.choice import has_known_suffix
from pellicle_fit.files.cleaning import clean
from pellicle_fit.files.columns import Calibration
from pellicle_fit.files.measurement import Measurement
from pellicle_fit.files.sources import gather

RADIUS, RATIO = 10e-6, 0.5
CALIBRATIONS = [
    Calibration(),
    *(Calibration(spring_constant=0.05, sensitivity=one) for one in (None, 50e-9, "50 nm/nA")),
]
"""Those tried in turn, of files in newtons, volts and amperes; they cancel in the comparison."""
STARTS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
"""Points of contact from which nanite searches, over the range of positions."""
RESTARTS = 10


@dataclass
class Outcome:
    """What became of a curve."""

    seconds: float
    error: str = ""
    modulus: float = np.nan
    """E with the tension fixed at 0 [Pa]."""
    nanite: float = np.nan
    """The same by nanite [Pa]."""
    gain: float = np.nan
    """Sum of squares of nanite's fit over ours."""
    points: int = 0
    is_open: bool = False
    """Whether the curve determines no modulus: its interval is open."""

    @property
    def difference(self) -> float:
        """E over nanite's, less 1."""
        return self.modulus / self.nanite - 1


def nanite_fit(curve: Measurement) -> tuple[float, float]:
    """Return Young's modulus [Pa] and sum of squares [N²] of nanite's Hertz fit to all rows."""
    # docs/nanite shares its name, so a plain import would have its type.
    nanite = import_module("nanite")
    models_available = import_module("nanite.model").models_available
    order = np.argsort(curve.position)
    position, force = curve.position[order], curve.force[order]
    data = {
        "tip position": -position,
        "force": force,
        "segment": np.zeros(order.size, dtype=np.uint8),
    }
    metadata = {"path": Path("curve"), "enum": 0, "imaging mode": "force-distance"}
    recording = nanite.Indentation(data, metadata)

    def search(start: Any) -> tuple[float, Any]:
        recording.fit_model(
            model_key="hertz_para",
            params_initial=start,
            preprocessing=[],
            weight_cp=0,
            range_x=(0, 0),
            segment=0,
            gcf_k=1.0,
            x_axis="tip position",
            y_axis="force",
        )
        if not recording.fit_properties["success"]:
            return np.inf, start
        residual = np.asarray(recording["force"] - recording["fit"])
        return float(np.nansum(residual**2)), recording.fit_properties["params_fitted"]

    ends = []
    for share in STARTS:
        start = models_available["hertz_para"].get_parameter_defaults()
        start["R"].value, start["nu"].value = RADIUS, RATIO
        deepest = (1 - share) * np.ptp(position)
        start["contact_point"].value = -(position[-1] - deepest)
        start["baseline"].value = force[: max(order.size // 10, 1)].mean()
        rise = np.ptp(force) * (1 - RATIO**2)
        start["E"].value = 0.75 * rise / np.sqrt(RADIUS * deepest**3)
        ends.append(search(start))
    total, parameters = min(ends, key=lambda end: end[0])
    # Its searches end before the minimum where the contact point is between two rows.
    for _ in range(RESTARTS):
        again, refined = search(parameters)
        if not again < total:
            break
        total, parameters = again, refined
    return float(parameters["E"].value), total


def outcome(curve: Measurement | PellicleError) -> Outcome:
    """Return what becomes of a curve."""
    began = process_time()
    if isinstance(curve, PellicleError):
        return Outcome(0.0, str(curve))
    options: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS, "poissons_ratio": RATIO}
    try:
        pl.fit(curve.position, curve.force, baseline="offset", **options)
    except PellicleError as error:
        return Outcome(process_time() - began, str(error))
    seconds = process_time() - began
    rows = clean(replace(curve, stiffness=None, time=None, speed=None))
    hertz = pl.fit(
        rows.position, rows.force, baseline="offset", fix={"tension": 0}, rivals=[], **options
    )
    assert hertz.youngs_modulus is not None
    modulus, total = nanite_fit(rows)
    squares = hertz.chi_squared * hertz.answer.selected.objective.noise[0] ** 2
    is_open = None in (hertz.reduced_modulus.low, hertz.reduced_modulus.high)
    return Outcome(
        seconds,
        "",
        hertz.youngs_modulus.value,
        modulus,
        total / squares,
        rows.force.size,
        is_open,
    )


def curves_of(path: Path) -> dict[str, Measurement | PellicleError]:
    """Return the curves of a file, with a calibration if it holds none."""
    for calibration in CALIBRATIONS:
        sources = gather(path, calibration, {})
        curves = {source.name: source.curve for source in sources}
        if any(isinstance(curve, Measurement) for curve in curves.values()):
            break
    return curves


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    warnings.simplefilter("ignore")
    print(
        "file | curves | fitted | slowest [s of CPU] | E over nanite's, largest change | not fitted"
    )
    print("--- | ---: | ---: | ---: | ---: | ---")
    for path in sorted(path for path in folder.rglob("*") if has_known_suffix(path)):
        curves = curves_of(path)
        outcomes = {label: outcome(curve) for label, curve in curves.items()}
        fitted = {label: result for label, result in outcomes.items() if not result.error}
        differences = [abs(result.difference) for result in fitted.values()]
        reasons = dict.fromkeys(result.error for result in outcomes.values() if result.error)
        print(
            path.name,
            len(outcomes),
            len(fitted),
            f"{max(result.seconds for result in outcomes.values()):.1f}",
            f"{100 * max(differences):.2g} %" if differences else "",
            "; ".join(reason.removeprefix(f"{path}: ") for reason in reasons),
            sep=" | ",
            flush=True,
        )
        for label, result in fitted.items():
            if abs(result.difference) > 1e-3:
                print(
                    f"{path.name}:{label}",
                    "",
                    "",
                    f"{result.seconds:.1f}",
                    f"{100 * result.difference:.3g} %",
                    f"E = {result.modulus:.4g} Pa, nanite {result.nanite:.4g} Pa with "
                    f"{result.gain:.6g} times the sum of squares, {result.points} points"
                    f"{'; the interval of E is open' if result.is_open else ''}",
                    sep=" | ",
                )


if __name__ == "__main__":
    main()
