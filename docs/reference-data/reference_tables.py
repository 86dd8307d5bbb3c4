"""Make the reference tables anew: ``python docs/reference-data/reference_tables.py [folder]``.

Every table is computed by the closed theory in ``pellicle_axisymmetric``, none by the
contact solver, which tests hold to these tables.  The column ``error`` bounds the relative error
of the values in its row.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from layer_equation import HalfSpace as HalfSpaceEquation
from layer_equation import half_space, moments
from scipy.interpolate import AAA
from scipy.special import beta

import pellicle as pl
from pellicle.arrays import Array
from pellicle.errors import ConvergenceError
from pellicle.surface.influence import cell_coefficients
from pellicle_axisymmetric.adhesive_contact import Adhesion
from pellicle_axisymmetric.indentation import indent
from pellicle_axisymmetric.tensed_punch import punch
from pellicle_plugins.closed_forms.hertz import sphere
from pellicle_plugins.closed_forms.sneddon import cone
from pellicle_plugins.indenters.of_revolution import Cone, Paraboloid
from pellicle_plugins.kernels.half_spaces import HalfSpace, TensedMembrane

Row = Sequence[float]
RATIOS = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
"""Elastocapillary lengths s = 2τ₀/E* over the contact radius."""


_NODES = 24
"""Moduli at which the stiffness of a punch on a solid that relaxes is known."""


class Table(NamedTuple):
    """A table of the data set."""

    name: str
    title: str
    derivation: str
    columns: Sequence[tuple[str, str]]
    """Name and meaning of each column; all quantities are dimensionless."""
    rows: Callable[[], Iterator[Row]]


def influence_cells() -> Iterator[Row]:
    """Yield K E*/D of square cells of side D."""
    for ratio in (0.0, 0.1, 1.0, 10.0):
        kernel: HalfSpace | TensedMembrane = HalfSpace(reduced_modulus=1.0)
        if ratio:
            kernel = TensedMembrane(reduced_modulus=1.0, tension=ratio / 2)
        cells = cell_coefficients(
            kernel.greens_function, kernel.radial_primitive, (17, 17), (1.0, 1.0)
        )
        for i, j in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (4, 0), (8, 3), (16, 16)):
            yield ratio, i, j, float(cells[i, j]), 1e-10


def tensed_paraboloid() -> Iterator[Row]:
    """Yield the contact of a paraboloid over that of Hertz at the same radius of contact."""
    hertz = sphere(1.0, 1.0, contact_radius=1.0)
    yield 0.0, 1.0, 1.0, 2 / np.pi, 0.0, 0.0
    for ratio in RATIOS:
        contact = indent(Paraboloid(radius=1.0), 1.0, ratio / 2, contact_radius=1.0)
        centre, edge = contact.pressure([0.0, 1.0])
        yield (
            ratio,
            contact.force / hertz.force,
            contact.depth / hertz.depth,
            float(centre),
            float(edge),
            1e-6,
        )


def tensed_cone() -> Iterator[Row]:
    """Yield the contact of a cone over that of Sneddon at the same radius of contact."""
    sneddon = cone(np.pi / 4, 1.0, contact_radius=1.0)
    yield 0.0, 1.0, 1.0, 0.0, 0.0
    for ratio in RATIOS:
        contact = indent(Cone(half_angle=np.pi / 4), 1.0, ratio / 2, contact_radius=1.0)
        (edge,) = contact.pressure([1.0])
        yield (
            ratio,
            contact.force / sneddon.force,
            contact.depth / sneddon.depth,
            float(edge),
            1e-6,
        )


def tensed_punch() -> Iterator[Row]:
    """Yield the stiffness of a flat punch and the share of its force on the rim."""
    yield 0.0, 2.0, 0.0, 0.0
    for ratio in RATIOS:
        contact = punch(1.0, 1.0, ratio / 2, depth=1.0)
        yield ratio, contact.force, contact.ring_force / contact.force, 1e-6


def layered_compliance() -> Iterator[Row]:
    """Yield the softness of a layer on a half-space against waves, both with ν of the row."""
    for ratio in (0.01, 0.1, 10.0, 100.0):
        for nu in (0.0, 0.3, 0.5):
            top = {"reduced_modulus": 1.0, "poissons_ratio": nu, "thickness": 1.0}
            base = {"youngs_modulus": ratio * (1 - nu**2), "poissons_ratio": nu}
            kernel = pl.kernel("layered", layers=[top], substrate=base)
            q = np.array([0.05, 0.2, 0.5, 1.0, 2.0, 5.0])
            for wave, value in zip(q, kernel.compliance(q) * q / 2, strict=True):
                yield ratio, nu, float(wave), float(value), 1e-9


def bonded_layer() -> Iterator[Row]:
    """Yield contacts of a paraboloid and a flat punch on a layer on a rigid base."""
    for ratio in (0.0, 0.1, 1.0):
        coarse, fine = (
            (half_space("smooth", ratio, level), half_space("punch", ratio, level))
            for level in (0, 1)
        )
        for nu in (0.0, 0.3, 0.5):
            for confinement in (0.2, 0.5, 1.0, 2.0, 5.0):
                values = _on_layer(*fine, confinement, nu)
                change = np.abs(_on_layer(*coarse, confinement, nu) / values - 1)
                yield ratio, nu, confinement, *map(float, values), max(float(change.max()), 1e-9)


def _on_layer(
    smooth: HalfSpaceEquation, flat: HalfSpaceEquation, confinement: float, nu: float
) -> Array:
    """Return force and depth of a paraboloid over Hertz, and the stiffness of a punch over 2."""
    bowl = moments(smooth, 2 * smooth.nodes.t[:, None], confinement, nu)
    end = moments(flat, np.ones((flat.nodes.t.size, 1)), confinement, nu)
    return np.array([bowl.force[0] * 3 / 4, bowl.depth[0], end.force[0] / 2])


def adhesive_paraboloid() -> Iterator[Row]:
    """Yield pull-off, the state without load, and the last state at a fixed depth."""
    for ratio in (0.0, *RATIOS):
        theory = Adhesion(Paraboloid(radius=1.0), 1.0, ratio / 2, 1.0)
        dead, unloaded = theory.instability(), theory.at_force(0.0)
        fixed = theory.instability(np.inf)
        yield (
            ratio,
            float(dead.force) / np.pi,
            float(dead.contact_radius),
            float(unloaded.contact_radius),
            float(unloaded.depth),
            float(fixed.contact_radius),
            float(fixed.depth),
            float(fixed.force) / np.pi,
            1e-6,
        )


def relaxing_punch() -> Iterator[Row]:
    """Yield the force after a step of depth on a standard linear solid, by correspondence."""
    times = np.array([0.03, 0.1, 0.3, 1.0, 3.0, 10.0])
    x = (1 - np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)) / 2
    for tension in (0.05, 0.5, 5.0):
        forces = [punch(1.0, float(1 + 4 * node), tension, depth=1.0).force for node in x]
        force, looser = (
            _relaxing_force(AAA(x, np.array(forces), rtol=tolerance), times)
            for tolerance in (1e-9, 1e-8)
        )
        for row in zip(times, force, np.maximum(np.abs(looser / force - 1), 1e-8), strict=True):
            yield tension, *map(float, row)


def _relaxing_force(stiffness: AAA, times: Array) -> Array:
    """Return the force at times of E(t) = 1 + 4e^(−t), for E(∞) = a = δ = 1.

    With K(E) the stiffness on an elastic solid, the Laplace transform of the force is K(E(p))/p,
    E(p) = 1 + 4x, x = p/(1 + p).  K is approximated by a rational function of x (Nakatsukasa, Sète
    & Trefethen 2018), whose poles p < 0 and residues are rates and terms of a sum of exponentials.
    """
    poles = stiffness.poles()
    rates = poles / (1 - poles)
    # The solid at rest relaxes between the rates −1 and −E(∞)/E(0).
    if np.any(rates.imag) or np.any((rates.real < -1) | (rates.real > -0.2)):
        raise ConvergenceError(f"rates {rates} are not those of a solid")
    terms = stiffness.residues() * (1 + rates) / (rates * (1 - poles))
    total = stiffness(np.zeros(1)) + np.exp(times[:, None] * rates) @ terms
    return np.asarray(total.real)


def power_law() -> Iterator[Row]:
    """Yield force and last contact of a paraboloid pressed and retracted at constant speed."""
    for exponent in (0.05, 0.1, 0.2, 0.3, 0.4):
        factor = 1.5 * beta(1.5, 1 - exponent)
        ratio = 2 ** (1 / (1 - exponent))
        yield exponent, float(factor), ratio / (ratio - 1), 1e-14


_ERROR = ("error", "upper bound of the relative error of the values in the row")
_S = ("s_over_a", "elastocapillary length s = 2 tau0/E* over the contact radius a")
_E = "E* = E/(1 - nu^2)"

TABLES = (
    Table(
        "influence_cells",
        f"Influence coefficients of square cells of side D on a half-space under tension; {_E}",
        "Integral of the Green's function of Hajji (1978), for s = 0 of Boussinesq, over the cell "
        "(Love 1929): signed sums of its radial primitive at the corners, Gauss points further out",
        (
            ("s_over_D", "elastocapillary length s = 2 tau0/E* over D"),
            ("i", "offset along x in cells"),
            ("j", "offset along y in cells"),
            (
                "K_E_over_D",
                "displacement at the centre of a cell under unit pressure on the "
                "cell i, j away, times E*/D",
            ),
            _ERROR,
        ),
        influence_cells,
    ),
    Table(
        "tensed_paraboloid",
        f"Rigid paraboloid of radius R on a half-space under tension; {_E}",
        "Integral equation of the axisymmetric contact after an Abel transform (Long, Ding, Yuan, "
        "Chen & Wang 2017), by collocation on graded panels, two meshes compared",
        (
            _S,
            ("F_over_Hertz", "force over 4 E* a^3/(3 R)"),
            ("depth_over_Hertz", "depth over a^2/R"),
            ("p_centre", "pressure at the centre over E* a/R"),
            ("p_edge", "pressure at the edge, from inside, over E* a/R"),
            _ERROR,
        ),
        tensed_paraboloid,
    ),
    Table(
        "tensed_cone",
        f"Rigid cone, flank m = cot(half-angle), on a half-space under tension; {_E}",
        "As tensed_paraboloid",
        (
            _S,
            ("F_over_Sneddon", "force over pi E* a^2 m/2"),
            ("depth_over_Sneddon", "depth over pi a m/2"),
            ("p_edge", "pressure at the edge, from inside, over E* m"),
            _ERROR,
        ),
        tensed_cone,
    ),
    Table(
        "tensed_punch",
        f"Rigid flat punch of radius a on a half-space under tension; {_E}",
        "As tensed_paraboloid; the solution has a line load on the rim",
        (
            _S,
            ("stiffness", "force over E* a times depth"),
            ("rim_share", "share of the force that the line load on the rim carries"),
            _ERROR,
        ),
        tensed_punch,
    ),
    Table(
        "layered_compliance",
        "Elastic layer of thickness h glued to an elastic half-space, against waves; all of "
        "Poisson's ratio nu",
        "Recursion over layers (Burmister 1945); equal to the closed form of Li, Pohrt, "
        "Lyashenko & Popov (2020)",
        (
            ("E_ratio", "Young's modulus of the half-space over that of the layer"),
            ("nu", "Poisson's ratio of both"),
            ("q_h", "wavenumber times h"),
            ("G_over_half_space", "compliance G(q) over 2/(E* q), E* of the layer"),
            _ERROR,
        ),
        layered_compliance,
    ),
    Table(
        "bonded_layer",
        f"Rigid paraboloid of radius R and flat punch on a layer of thickness h, glued to a rigid "
        f"base, under tension; {_E}",
        "Integral equation of tensed_paraboloid with a smooth part more for the layer (Hayes, "
        "Keer, Herrmann & Mockros 1972), by collocation on graded panels, two meshes compared",
        (
            _S,
            ("nu", "Poisson's ratio of the layer"),
            ("a_over_h", "contact radius a over h"),
            ("F_over_Hertz", "force on the paraboloid over 4 E* a^3/(3 R)"),
            ("depth_over_Hertz", "its depth over a^2/R"),
            ("punch_over_half_space", "force on a flat punch of radius a over 2 E* a times depth"),
            _ERROR,
        ),
        bonded_layer,
    ),
    Table(
        "adhesive_paraboloid",
        "Rigid paraboloid that sticks to a half-space under tension, without range; "
        "a0 = (w R^2/E*)^(1/3), lengths over a0, depths over a0^2/R, forces over pi w R",
        "Contact without adhesion of each radius and a flat punch retracted by sqrt(4 pi a w/k'), "
        "k' the derivative of its stiffness; s = 0 is Johnson, Kendall & Roberts (1971)",
        (
            ("s_over_a0", "elastocapillary length s = 2 tau0/E* over a0"),
            ("F_pull_off", "least force under a dead load"),
            ("a_pull_off", "contact radius there"),
            ("a_no_load", "contact radius at no load"),
            ("depth_no_load", "depth there"),
            ("a_fixed_depth", "contact radius of the last state under a prescribed depth"),
            ("depth_fixed_depth", "depth there"),
            ("F_fixed_depth", "force there"),
            _ERROR,
        ),
        adhesive_paraboloid,
    ),
    Table(
        "relaxing_punch",
        "Flat punch pressed at once and held, on a solid E*(t) = E_inf (1 + 4 exp(-t/T)) under an "
        "elastic tension tau0",
        "Correspondence principle: the stiffness of tensed_punch as a rational function of "
        "E*(p), inverted by its poles",
        (
            ("tau0_over_E_inf_a", "tension over E_inf a"),
            ("t_over_T", "time over T"),
            ("F", "force over E_inf a times depth"),
            _ERROR,
        ),
        relaxing_punch,
    ),
    Table(
        "power_law",
        "Paraboloid pressed at constant speed v and drawn back at the same speed from time t_max, "
        "on a solid E*(t) = E0 (t/t0)^(-alpha) without tension",
        "Lee & Radok (1960) while the contact grows, Ting (1966) for its end; closed forms",
        (
            ("alpha", "exponent"),
            ("F", "force over (4/3) sqrt(R) E0 t0^alpha v^1.5 t^(1.5 - alpha) while pressed"),
            ("t_end", "time of last contact over t_max"),
            _ERROR,
        ),
        power_law,
    ),
)


def write(table: Table, folder: Path) -> Path:
    """Write a table as CSV with its description in comments, and return its path."""
    path = folder / f"{table.name}.csv"
    with path.open("w", encoding="utf-8", newline="") as file:
        lines = (
            f"{table.title}.",
            f"Derivation: {table.derivation}.",
            "All columns are dimensionless:",
            *(f"  {name}: {meaning}" for name, meaning in table.columns),
            f"Made by pellicle {pl.__version__}, docs/reference-data/reference_tables.py. CC0 1.0.",
        )
        file.writelines(f"# {line}\n" for line in lines)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([name for name, _ in table.columns])
        writer.writerows([f"{value:.12g}" for value in row] for row in table.rows())
    return path


if __name__ == "__main__":
    goal = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    for entry in TABLES:
        print(write(entry, goal))
