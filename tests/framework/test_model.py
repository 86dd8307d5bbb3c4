"""Frozen models and the words of their errors."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Annotated, Literal

import pytest
from pydantic import Field

from pellicle.errors import ConfigError, Problem, shown
from pellicle.model import InputPath, Model, nearest, paths_relative_to
from pellicle.units import Length


class Part(Model):
    """A part with one field of each kind."""

    length: Annotated[Length, Field(description="how long [m]")]
    count: Annotated[int, Field(gt=0, description="how many")] = 1
    switch: Annotated[bool, Field(description="on or off")] = False
    ratio: Annotated[float, Field(le=1, description="how much", allow_inf_nan=False)] = 0.0
    kind: Annotated[Literal["plain", "fancy"], Field(description="which")] = "plain"
    names: Annotated[tuple[str, ...], Field(min_length=1, description="what")] = ("a",)
    pair: Annotated[tuple[int, int], Field(description="two")] = (1, 1)


class Whole(Model):
    """A model that holds parts."""

    part: Annotated[Part, Field(description="a part")]
    parts: Annotated[tuple[Part, ...], Field(description="more parts")] = ()


def _problems(model: type[Model], **data: object) -> dict[str, str]:
    with pytest.raises(ConfigError) as caught:
        model(**data)
    return {problem.field: problem.message for problem in caught.value.problems}


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("length", "1 N", "'1 N' is a force; give"),
        ("count", "x", "'x' is not allowed; give a whole number (how many)"),
        ("count", 1.5, "1.5 is not allowed; give a whole number (how many)"),
        ("count", 0, "0 is not allowed; give a value > 0 (how many)"),
        ("count", None, "None is not allowed; give a whole number (how many)"),
        ("switch", "maybe", "'maybe' is not allowed; give true or false (on or off)"),
        ("ratio", "x", "'x' is not allowed; give a number (how much)"),
        ("ratio", float("nan"), "nan is not allowed; give a finite number (how much)"),
        ("ratio", 2, "2 is not allowed; give a value ≤ 1.0 (how much)"),
        ("kind", "fanzy", "'fanzy' is not allowed; did you mean 'fancy'? Known: fancy, plain"),
        ("names", "abc", "'abc' is not allowed; give a list (what)"),
        ("names", [], "[] is not allowed; give a list of 1 or more (what)"),
        ("pair", [1, 2, 3], "[1, 2, 3] is not allowed; give a list of 2 or fewer (two)"),
        ("lenght", 1, "is not a field here; did you mean 'length'?"),
    ],
)
def test_message(field: str, value: object, message: str) -> None:
    """An error names field, value, what is allowed and what the field is."""
    problems = _problems(Part, **{"length": 1, field: value})
    assert list(problems) == [field]
    assert problems[field].startswith(message)


def test_missing_field() -> None:
    """A missing field is described."""
    assert _problems(Part) == {"length": "is missing; give it: how long [m]"}


def test_path_through_models() -> None:
    """A problem deep inside is named by its dotted path, lists counted from 0."""
    problems = _problems(
        Whole, part={"length": 0}, parts=[{"length": 1}, {"length": 1, "count": 0}]
    )
    assert list(problems) == ["part.length", "parts.1.count"]


def test_bad_entry_is_said_once() -> None:
    """A list whose only entry is bad is not called too short as well."""
    assert list(_problems(Part, length=1, names=[1])) == ["names.0"]


def test_table_for_a_value_and_the_reverse() -> None:
    """A table where a value is wanted, and a value where a table is, are told apart."""
    assert "give a whole number" in _problems(Part, length=1, count={"a": 1})["count"]
    assert "give a table (a part)" in _problems(Whole, part=3)["part"]


def test_frozen() -> None:
    """A model cannot be changed."""
    part = Part(length=1)
    with pytest.raises(ValueError, match="frozen"):
        part.length = 2  # type: ignore[misc]


def test_nearest() -> None:
    """The nearest known word is suggested if there is one, and all are listed."""
    assert nearest("tensoin", ["tension", "modulus"]) == (
        "did you mean 'tension'? Known: modulus, tension"
    )
    assert nearest("x", ["tension"]) == "Known: tension"
    assert nearest("x", []) == "Known: none"


class Reader(Model):
    """A model with a file."""

    path: InputPath


def test_paths_are_relative_to_the_file(tmp_path: Path) -> None:
    """Within a TOML file a relative path is seen from its folder, and elsewhere left alone."""
    with paths_relative_to(tmp_path):
        assert Reader(path="a/b.npy").path == tmp_path / "a/b.npy"
        assert Reader(path=Path.home() / "c.npy").path == Path.home() / "c.npy"
    assert Reader(path="a/b.npy").path == Path("a/b.npy")


def test_config_error() -> None:
    """ConfigError is a ValueError, holds its problems, and survives pickling."""
    error = ConfigError([Problem("a.b", "is bad"), Problem("", "all is bad")])
    assert isinstance(error, ValueError)
    assert str(error) == "a.b: is bad\nall is bad"
    again = pickle.loads(pickle.dumps(error))
    assert again.problems == error.problems
    assert str(again) == str(error)


def test_config_error_within() -> None:
    """An error seen from further out has longer paths."""
    inner = ConfigError([Problem("b", "is bad"), Problem("", "all is bad")])
    assert [problem.field for problem in inner.within("a").problems] == ["a.b", "a"]


def test_shown() -> None:
    """A value in a message is on one line and not for ever."""
    assert shown("a\nb") == r"'a\nb'"
    assert len(shown("x" * 1000)) < 60
