"""Arithmetic over dotted names, and nothing but that."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from pellicle import ConfigError
from pellicle.schema.expression import evaluate, names_in

NAMES = {"kernel.tension": 0.5, "kernel.reduced_modulus": 1e4, "depth": 3.0, "grid.size.0": 2.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2 * kernel.tension / kernel.reduced_modulus", 1e-4),
        ("-depth**2", -9.0),
        ("(-depth)**2", 9.0),
        ("2**-1", 0.5),
        ("1 - 2 - 3", -4.0),
        ("+1e3 - 1.5e-3 + .5", 1000.4985),
        ("sqrt(depth + 1) * pi", 2 * math.pi),
        ("log10(exp(log(100)))", 2.0),
        ("abs(-depth)", 3.0),
        ("grid.size.0**2", 4.0),
        ("  depth ", 3.0),
        ("1" + "+1" * 300, 301.0),
    ],
)
def test_is_arithmetic(text: str, value: float) -> None:
    """Precedence, functions, numbers and dotted names are as everywhere."""
    assert evaluate(text, NAMES) == pytest.approx(value, rel=1e-15)


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.floats(-3, 3))
def test_agrees_with_python(a: float, b: float, c: float) -> None:
    """Any numbers give what Python gives."""
    expected = -a + b * (a - c) / b**c
    assert evaluate("-a + x.b * (a - c) / x.b**c", {"a": a, "x.b": b, "c": c}) == expected


def test_broadcasts_by_dimension() -> None:
    """Variables of xarray meet by the names of their dimensions."""
    a = xr.DataArray([1.0, 2.0], dims="t")
    b = xr.DataArray([10.0, 20.0, 30.0], dims="seed")
    value = evaluate("a * b + 1", {"a": a, "b": b})
    assert value.dims == ("t", "seed")
    np.testing.assert_array_equal(value, [[11, 21, 31], [21, 41, 61]])


def test_undefined_values_are_not_a_number() -> None:
    """A division by zero or a root of what is negative spoils its own value only."""
    value = evaluate("sqrt(a) / b", {"a": np.array([4.0, -1.0, 1.0]), "b": np.array([1, 1, 0])})
    np.testing.assert_array_equal(value, [2.0, np.nan, np.inf])
    assert evaluate("1 / 0", {}) == np.inf


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "'' is not arithmetic"),
        ("depth if depth else 1", "is not arithmetic"),
        ("__import__('os')", "'__import__' in .* is not a function|not allowed"),
        ("'text'", "'text'.* is not allowed"),
        ("[depth]", r"'\[depth\]' in .* is not allowed"),
        ("(depth).real", r"^'\(depth\)\.real' in .* is not allowed"),
        ("depth // 2", "'depth // 2' in .* is not allowed"),
        ("(kernel.tension := 2)", "not allowed"),
        ("2j", "'2j' in .* is not allowed"),
        ("True", "'True' in"),
        ("sqrt", "'sqrt' in"),
        ("sqrt(depth)(2)", "is not allowed"),
        ("τ * 2", "'τ' in"),
        ("(" * 249 + "1" + ")" * 249, "not arithmetic"),
        ("~" * 499 + "1", "is not allowed"),
        *((text, "more than 300 operations") for text in ("1" + "+1" * 301, "-" * 100_000 + "1")),
        *((f"{text}1", "is not arithmetic") for text in ("~" * 100_000, "not " * 100_000)),
        *(
            (text, "is not arithmetic")
            for text in ("℘5", "depth * ℘0", "℮9", "ᢅ5", "e\u0301", "a·b", "depth # / 2")
        ),
        ("1" * 400, "cannot be evaluated|not arithmetic"),
    ],
)
def test_anything_else_is_refused(text: str, message: str) -> None:
    """What is not arithmetic is named, and what would be allowed."""
    with pytest.raises(ConfigError, match=message):
        evaluate(text, NAMES)


def test_names_that_are_needed() -> None:
    """Functions and constants are not among them, nor exponents of numbers."""
    assert names_in("sqrt(a.b) / pi + 1e3 * c") == {"a.b", "c"}
