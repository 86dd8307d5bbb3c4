"""Quantities: numbers, texts with a unit and pint quantities, all held in SI."""

from __future__ import annotations

import math
import re
from fractions import Fraction

import numpy as np
import pint
import pytest

from pellicle.units import Quantity

TENSION = Quantity("N/m", at_least=0)
RATIO = Quantity("1", above=-1, at_most=0.5)


@pytest.mark.parametrize(
    ("unit", "given", "expected"),
    [
        ("m", 0.01, 0.01),
        ("m", 3, 3.0),
        ("m", Fraction(1, 4), 0.25),
        ("m", np.float32(0.5), 0.5),
        ("m", np.int64(7), 7.0),
        ("m", "10 um", 1e-5),
        ("m", "10 µm", 1e-5),
        ("m", "10um", 1e-5),
        ("m", "  1.5e-3   mm ", 1.5e-6),
        ("m", "+.5 m", 0.5),
        ("m", "5. nm", 5e-9),
        ("Pa", "10 kPa", 1e4),
        ("Pa", "1 N/mm**2", 1e6),
        ("Pa", "1 N/mm^2", 1e6),
        ("N/m", "50 mN/m", 0.05),
        ("N/m", "50 mJ/m^2", 0.05),
        ("N/m", "50 dyn/cm", 0.05),
        ("N", "2 uN", 2e-6),
        ("rad", "180 degree", math.pi),
        ("1", 0.3, 0.3),
        ("1", "0.3", 0.3),
    ],
)
def test_value_in_si(unit: str, given: object, expected: float) -> None:
    """A number is taken as SI, and a text with a unit is converted to it."""
    value = Quantity(unit)(given)
    assert type(value) is float
    assert value == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("magnitude", [10, 10.0, np.float64(10.0), np.int32(10)])
def test_pint_quantity(magnitude: float) -> None:
    """A pint quantity is converted whatever the type of its magnitude, and its registry."""
    given = pint.UnitRegistry().Quantity(magnitude, "mN/m")
    assert TENSION(given) == pytest.approx(0.01, rel=1e-14)


def test_pint_pure_number() -> None:
    """A dimensionless pint quantity is a pure number."""
    assert RATIO(pint.UnitRegistry().Quantity(0.25, "")) == 0.25


@pytest.mark.parametrize("given", [0, 0.0, "0 N/m", -0.0])
def test_closed_bound_is_allowed(given: object) -> None:
    """``at_least`` and ``at_most`` include the bound itself."""
    assert TENSION(given) == 0
    assert RATIO(0.5) == 0.5


@pytest.mark.parametrize("given", [-1, -1.5, "-1", 0.500001])
def test_open_bound_is_refused(given: object) -> None:
    """``above`` excludes the bound, and nothing beyond the other one is allowed."""
    with pytest.raises(ValueError, match=r"is not allowed; give a plain number > -1 and ≤ 0\.5"):
        RATIO(given)


@pytest.mark.parametrize(
    "given",
    [math.nan, math.inf, -math.inf, "nan", "inf", "-Infinity", "nan N/m", "-INF mN/m", "1e999 N/m"],
)
def test_not_finite(given: object) -> None:
    """Nothing infinite or undefined passes, in whatever spelling."""
    with pytest.raises(ValueError, match="is not finite; give a value ≥ 0 N/m"):
        TENSION(given)


@pytest.mark.parametrize("given", [1e101, "1e200 mN/m", 1e-101, 5e-324])
def test_numbers_without_squares(given: object) -> None:
    """No area or energy is made of a number whose square over- or underflows."""
    with pytest.raises(ValueError, match="is too large or too near 0 to compute with"):
        TENSION(given)


def test_exponent_beyond_decimals() -> None:
    """A power of ten beyond any number is not finite, or 0, and no fault of the unit."""
    with pytest.raises(ValueError, match="is not finite"):
        TENSION("1e99999999999999999999 N/m")
    assert TENSION("1e-99999999999999999999 N/m") == 0


def test_integer_beyond_floats() -> None:
    """A whole number too large for a float is refused, not an overflow."""
    with pytest.raises(ValueError, match="is not finite"):
        TENSION(10**400)


@pytest.mark.parametrize("given", [None, True, [1.0], {}, b"1 N/m", 1j, "", "N/m", "1,5 N/m"])
def test_not_a_number(given: object) -> None:
    """Anything that is no number is refused with an example of what is."""
    with pytest.raises(ValueError, match="'50 mN/m'"):
        TENSION(given)


@pytest.mark.parametrize(
    ("unit", "noun"),
    [
        ("m", "a length"),
        ("Pa", "a pressure"),
        ("mN", "a force"),
        ("s", "a time"),
        ("degC", "a temperature"),
        ("kg", "a mass"),
        ("N*m", "an energy"),
        ("m/s", "a speed"),
        ("%", "a pure number"),
        ("degree", "an angle"),
        ("count", "a value in count"),
        ("m**7", r"a value in m\*\*7"),
    ],
)
def test_other_dimension(unit: str, noun: str) -> None:
    """A unit of another dimension is refused in words."""
    with pytest.raises(ValueError, match=rf"'1 {re.escape(unit)}' is {noun}; give"):
        TENSION(f"1 {unit}")


@pytest.mark.parametrize("unit", ["%", "percent", "dB", "Np", "octave", "count", "sr", "m/m", "um"])
def test_no_angle(unit: str) -> None:
    """What has no dimension is not for that an angle: a slope of 5 % is not 0.05 rad."""
    with pytest.raises(ValueError, match=r"is an? .*; give .*'70 degree'"):
        Quantity("rad")(f"5 {unit}")


@pytest.mark.parametrize(
    ("given", "expected"), [("90°", 0.5), ("0.25 turn", 0.5), ("100 gon", 0.5)]
)
def test_angle(given: str, expected: float) -> None:
    """Whatever measures an angle is one; in multiples of π."""
    assert Quantity("rad")(given) == pytest.approx(expected * math.pi, rel=1e-14)


@pytest.mark.parametrize("unit", ["foo", "N/", "N/m)", "2 N/m", "N + m", "N/0", "__import__('os')"])
def test_unknown_unit(unit: str) -> None:
    """Whatever does not parse as a unit is refused in our words, not in pint's."""
    with pytest.raises(ValueError, match="has an unknown unit"):
        TENSION(f"1 {unit}")


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
        "(" * 5000 + "Pa" + ")" * 5000,
    ],
)
def test_unit_that_would_never_end(unit: str) -> None:
    """Towers of powers and endless texts are refused at once: pint is not given them."""
    with pytest.raises(ValueError, match="has an unknown unit"):
        Quantity("Pa")(f"1 {unit}")


@pytest.mark.parametrize("unit", ["Pa\0", "{Pa}", "Pa#x", "Pa\x1b[2J", "Pa;Pa", "[Pa]"])
def test_unit_with_marks_of_other_languages(unit: str) -> None:
    """A unit is letters, small powers, products and quotients; nothing else is ignored."""
    with pytest.raises(ValueError, match="has an unknown unit"):
        Quantity("Pa")(f"1 {unit}")


@pytest.mark.parametrize(
    ("unit", "given", "message"),
    [
        ("K", "20 degC", r"a unit whose zero is 273\.15 K"),
        ("W", "3 dBm", r"a unit whose zero is 0\.001 W"),
        ("m", "1 um**99/m**98", "a unit of 0 m"),
    ],
)
def test_unit_that_no_factor_converts(unit: str, given: str, message: str) -> None:
    """A scale with another zero, a logarithm and a vanishing factor are refused, not multiplied."""
    with pytest.raises(ValueError, match=message):
        Quantity(unit)(given)


@pytest.mark.parametrize(
    ("unit", "given", "expected"),
    [
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
    ],
)
def test_units_as_people_write_them(unit: str, given: str, expected: float) -> None:
    """Dots, superscripts, roots, words and parentheses are read."""
    assert Quantity(unit)(given) == pytest.approx(expected, rel=1e-14)


def test_long_value_is_shortened() -> None:
    """A message quotes a long value in part."""
    with pytest.raises(ValueError, match="…") as caught:
        TENSION("9" * 10_000)
    assert len(str(caught.value)) < 250


def test_unit_for_a_pure_number() -> None:
    """A pure number takes no unit."""
    with pytest.raises(ValueError, match=r"'0\.3 Pa' has a unit; give a plain number"):
        RATIO("0.3 Pa")


@pytest.mark.parametrize(
    ("unit", "powers"),
    [
        ("m", (0, 1)),
        ("Pa", (1, 0)),
        ("N/m", (1, 1)),
        ("N*m", (1, 3)),
        ("Pa/m", (1, -1)),
        ("1", (0, 0)),
    ],
)
def test_powers(unit: str, powers: tuple[int, int]) -> None:
    """A unit is one of pressure and one of length, to some powers."""
    assert Quantity(unit).powers() == powers
