"""Quantities: numbers, texts with a unit and pint quantities, all held in SI."""

import math
import re
from fractions import Fraction

import numpy as np
import pint
import pytest

from pellicle.units import Quantity, unit_quantity

UREG: pint.UnitRegistry[float] = pint.UnitRegistry()
TENSION = Quantity("N/m", at_least=0)


@pytest.mark.parametrize(
    ("unit", "given", "expected"),
    [
        ("m", 0.01, 0.01),
        ("m", Fraction(1, 4), 0.25),
        ("m", np.int64(7), 7.0),
        ("m", "10 um", 1e-5),
        ("m", "10 µm", 1e-5),
        ("m", "  1.5e-3   mm ", 1.5e-6),
        ("m", "+.5m", 0.5),
        ("m", "5. nm", 5e-9),
        ("m", "1e-99999999999999999999 m", 0.0),
        ("Pa", "1 N/mm**2", 1e6),
        ("N/m", "50 mJ/m^2", 0.05),
        ("N/m", "50 dyn/cm", 0.05),
        ("N/m", UREG.Quantity(10, "mN/m"), 0.01),
        ("N/m", UREG.Quantity(np.int32(10), "mN/m"), 0.01),
        ("N/m", "0 N/m", 0.0),
        ("1", "0.3", 0.3),
        ("1", UREG.Quantity(0.25, ""), 0.25),
        # Whatever measures an angle is one.
        ("rad", "180 degree", math.pi),
        ("rad", "90°", 0.5 * math.pi),
        ("rad", "0.25 turn", 0.5 * math.pi),
        ("rad", "100 gon", 0.5 * math.pi),
        # Dots, superscripts, roots, words and parentheses.
        ("N*m", "3 N·m", 3.0),
        ("N*m", "3 N⋅m", 3.0),
        ("N*m", "3 N×mm", 3e-3),
        ("1/m", "3 1/mm", 3e3),
        ("1/m", "3 mm⁻¹", 3e3),
        ("N/m", "3 newton per meter", 3.0),
        ("Pa*m**0.5", "3 MPa*m**(1/2)", 3e6),
        ("Pa*m**0.5", "3 MPa m^0.5", 3e6),
        ("J", "3 kg·m²·s⁻²", 3.0),
        ("Pa/m", "3 ((N / mm ** 2) / (mm))", 3e9),
        ("m", "3 Å", 3e-10),
        # Powers as datasets and UDUNITS write them; pint has units that end in other digits.
        ("m2", "3 mm2", 3e-6),
        ("m3", "3 mm^3", 3e-9),
        ("kg/m3", "3 g / cm3", 3e3),
        ("m", "1 a0", UREG("a0").to("m").magnitude),
    ],
)
def test_value_in_si(unit: str, given: object, expected: float) -> None:
    """A number is taken as SI; a text with a unit and a pint quantity are converted to it."""
    value = Quantity(unit)(given)
    assert type(value) is float
    assert value == pytest.approx(expected, rel=1e-14)


def test_bounds() -> None:
    """``at_least`` and ``at_most`` include the bound itself, ``above`` and ``below`` do not."""
    ratio = Quantity("1", above=-1, at_most=0.5)
    assert (TENSION(-0.0), ratio(0.5), ratio("-0.99")) == (0, 0.5, -0.99)
    for given in (-1, "-1", 0.500001):
        with pytest.raises(ValueError, match="a plain number > -1 and ≤ 0"):
            ratio(given)
    with pytest.raises(ValueError, match="is not allowed; give a plain number < 2"):
        Quantity("1", below=2)(2)


FINITE = "is not finite; give a value ≥ 0 N/m"
EXAMPLE = "'50 mN/m'"
UNKNOWN = "has an unknown unit"


REFUSED: list[tuple[Quantity, str, object]] = [
    *((TENSION, FINITE, given) for given in ("nan", "-Infinity", "-INF mN/m", "1e999 N/m")),
    (TENSION, FINITE, "1e99999999999999999999 N/m"),
    *((TENSION, EXAMPLE, given) for given in (None, set[int](), b"1 N/m", 1j, "1,5 N/m")),
    # What does not parse is refused in our words, not in pint's, and nothing of it is ignored.
    *((TENSION, UNKNOWN, f"1 {unit}") for unit in ("foo", "N/", "N/m)", "2 N/m", "N + m")),
    *((TENSION, UNKNOWN, f"1 {unit}") for unit in ("N/0", "__import__('os')", "N/m\0")),
    *((TENSION, UNKNOWN, f"1 {unit}") for unit in ("{N/m}", "N/m#x", "N/m\x1b[2J", "[N/m]")),
    (
        Quantity("Pa*m"),
        "'1 N' is in N, which is no unit of Pa*m; give a value with its unit",
        "1 N",
    ),
    # No area or energy is made of a number whose square over- or underflows.
    *((TENSION, "too large or too near 0", given) for given in (1e101, "1e200 mN/m", 5e-324)),
    *(
        (TENSION, f"'1 {unit}' is in … no unit of N/m; give", f"1 {unit}")
        for unit in ("degC", "N*m", "%", "degree", "count", "m**7")
    ),
    # What has no dimension is not for that an angle: a slope of 5 % is not 0.05 rad.
    *(
        (Quantity("rad"), "is in …; give …'70 degree'", f"5 {unit}")
        for unit in ("%", "dB", "count", "sr", "m/m")
    ),
    # No factor converts another zero, a logarithm and what vanishes.
    (Quantity("K"), "a unit whose zero is 273.15 K", "20 degC"),
    (Quantity("W"), "a unit whose zero is 0.001 W", "3 dBm"),
    (Quantity("m"), "a unit of 0 m", "1 um**99/m**98"),
]


@pytest.mark.parametrize(("quantity", "message", "given"), REFUSED)
def test_refused(quantity: Quantity, message: str, given: object) -> None:
    """What is no value of the quantity is refused with what is."""
    with pytest.raises(ValueError, match=re.escape(message).replace("…", ".*")):
        quantity(given)


@pytest.mark.parametrize(
    "unit",
    [
        "Pa*9**9**9**9",
        "9**9**9*Pa",
        "Pa^9^9^9^9",
        "Pa⁹⁹⁹⁹⁹⁹⁹⁹ ⁹⁹⁹⁹⁹⁹⁹⁹",
        "Pa*(9**9**9)",
        "((yd**99)**99)**99",
        "yd⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹",
        "Pa" + " " * 1_000_000 + "(",
        "m*" * 100_000 + "m",
        "m" + (" " * 9 + "m") * 9 + "(",
        "(" * 5000 + "Pa" + ")" * 5000,
        "Pa;Pa",
    ],
)
def test_unit_that_would_never_end(unit: str) -> None:
    """Towers of powers and endless texts are refused at once: pint is not given them."""
    with pytest.raises(ValueError, match="has an unknown unit") as caught:
        Quantity("Pa")(f"1 {unit}")
    assert len(str(caught.value)) < 250
    with pytest.raises(ValueError, match="has an unknown unit"):
        unit_quantity(unit)


def test_powers() -> None:
    """A unit is one of force, one of length and one of time, to some powers."""
    units = {"1": (0, 0, 0), "m": (0, 1, 0), "Pa": (1, -2, 0), "N*m": (1, 1, 0), "N/s": (1, 0, -1)}
    assert {unit: Quantity(unit).powers() for unit in units} == units
