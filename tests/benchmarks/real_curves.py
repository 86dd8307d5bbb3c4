"""Every curve in a folder of measured curves: how it ends, how long it takes, and against nanite.

Run it: ``python tests/benchmarks/real_curves.py FOLDER``.  It prints a row for each file, and one for
each curve whose modulus differs from nanite's by more than 0.1 %, which is not rounding.

Each curve is fitted twice: as a user would, with the tension free; and with the tension fixed at 0
and the position of the tip, which is what nanite's model ``hertz_para`` fits, with all rows equal.
Its rows are then given to nanite.  The test data of nanite and afmformats, unpacked from their
source distributions, are such folders.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

import numpy as np

import pellicle as pl
from pellicle.errors import PellicleError
from pellicle.fitting.curves.columns import Calibration
from pellicle.fitting.curves.curve import Curve, clean
from pellicle.fitting.curves.readers import SUFFIXES, read

RADIUS, RATIO = 10e-6, 0.5
CALIBRATION = Calibration(spring_constant=0.05, sensitivity=50e-9)
"""Of files in volts; it cancels in the comparison."""


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

    @property
    def difference(self) -> float:
        """E over nanite's, less 1."""
        return self.modulus / self.nanite - 1


def nanite_fit(curve: Curve) -> tuple[float, float]:
    """Return Young's modulus [Pa] and sum of squares [N²] of nanite's Hertz fit to all rows."""
    import nanite
    from nanite.model import models_available

    order = np.argsort(curve.position)
    data = {
        "tip position": -curve.position[order],
        "force": curve.force[order],
        "segment": np.zeros(order.size, dtype=np.uint8),
    }
    metadata = {"path": Path("curve"), "enum": 0, "imaging mode": "force-distance"}
    recording = nanite.Indentation(data, metadata)
    start = models_available["hertz_para"].get_parameter_defaults()
    start["R"].value, start["nu"].value = RADIUS, RATIO
    depth = -recording["tip position"]
    rise = float(np.ptp(curve.force))
    best = np.inf, np.nan
    # Levenberg-Marquardt ends in the nearest minimum, so the contact is sought from several.
    for share in (0.1, 0.3, 0.5, 0.7, 0.9):
        start["contact_point"].value = -float(depth[0] + share * np.ptp(depth))
        deepest = (1 - share) * float(np.ptp(depth))
        start["E"].value = rise * 0.75 * (1 - RATIO**2) / np.sqrt(RADIUS * deepest**3)
        start["baseline"].value = float(np.median(curve.force[order][: max(order.size // 10, 1)]))
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
            continue
        residual = recording["force"] - recording["fit"]
        total = float(np.nansum(np.asarray(residual) ** 2))
        best = min(best, (total, float(recording.fit_properties["params_fitted"]["E"].value)))
    return best[1], best[0]


def outcome(curve: Curve | PellicleError) -> Outcome:
    """Return what becomes of a curve."""
    began = perf_counter()
    if isinstance(curve, PellicleError):
        return Outcome(0.0, str(curve))
    options = {"indenter": "paraboloid", "radius": RADIUS, "poissons_ratio": RATIO}
    try:
        pl.fit(curve.position, curve.force, baseline="offset", **options)
    except PellicleError as error:
        return Outcome(perf_counter() - began, str(error))
    seconds = perf_counter() - began
    rows = clean(replace(curve, stiffness=None, time=None, speed=None))
    hertz = pl.fit(rows.position, rows.force, baseline="offset", fix={"tension": 0}, **options)
    assert hertz.youngs_modulus is not None
    modulus, total = nanite_fit(rows)
    squares = hertz.chi_squared * hertz.noise**2
    return Outcome(
        seconds, "", hertz.youngs_modulus.value, modulus, total / squares, rows.force.size
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    warnings.simplefilter("ignore")
    print("file | curves | fitted | slowest [s] | E over nanite's, largest difference | not fitted")
    print("--- | ---: | ---: | ---: | ---: | ---")
    for path in sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES):
        try:
            curves = read(path)
        except PellicleError as error:
            try:
                curves = read(path, CALIBRATION)
            except PellicleError:
                curves = {"": error}
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
                    f"{result.gain:.6g} times the sum of squares, {result.points} points",
                    sep=" | ",
                )


if __name__ == "__main__":
    main()
