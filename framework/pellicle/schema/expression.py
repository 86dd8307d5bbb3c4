"""Arithmetic over dotted names, as in study files and figures.

The value of ``kernel.tension / kernel.reduced_modulus`` is a number, a numpy array or an xarray
variable, like the values of its names. Python's parser reads the text; only arithmetic is allowed.
"""

from __future__ import annotations

import ast
import operator
import re
import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from pellicle.errors import ConfigError, excerpt

from .messages import nearest

FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    "sqrt": np.sqrt,
    "log": np.log,
    "log10": np.log10,
    "exp": np.exp,
    "abs": np.abs,
}
"""Functions of one argument."""
CONSTANTS = {"pi": np.pi, "π": np.pi}
"""Names with a fixed value."""

_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
}
_NAME = re.compile(r"(?<![\w.])[^\W\d]\w*(?:\.\w+)*")
_TOKEN = re.compile(
    rf"(?P<name>{_NAME.pattern})|\s*\*\*\s*(?P<power>[2-9])(?![\w.])|\s*(?:\*\*|[*/])\s*"
)
_RAISED = str.maketrans("23456789", "²³⁴⁵⁶⁷⁸⁹")
_SIGNS = {"**": "^", "*": "·", "/": "/"}
_GREEK = {"pi": "π"}
_LONGEST = 300
"""Operations of an expression, each of which may nest in the one before."""
_ALLOWED = f"+ - * / ** ( ), {', '.join(FUNCTIONS)} and {', '.join(CONSTANTS)}"


def names_in(text: str) -> set[str]:
    """Return the dotted names in ``text`` that are neither functions nor constants."""
    return set(_NAME.findall(text)) - FUNCTIONS.keys() - CONSTANTS.keys()


def formula(text: str, words: Callable[[str], str]) -> str:
    """Return ``text`` as readers write it, with ``words`` in place of its dotted names."""

    def shown(match: re.Match[str]) -> str:
        name = match["name"]
        if match["power"]:
            return match["power"].translate(_RAISED)
        if name is None:
            return f" {_SIGNS[match[0].strip()]} "
        is_function = text[match.end() :].lstrip().startswith("(")
        return name if is_function else _GREEK.get(name) or words(name)

    return _TOKEN.sub(shown, text.strip())


def evaluate(
    text: str, names: Mapping[str, Any], functions: Mapping[str, Callable[[Any], Any]] | None = None
) -> Any:
    """Return the value of ``text``: arithmetic over ``names``.

    Parameters
    ----------
    text
        Numbers, dotted names, ``+ - * / **``, parentheses and `FUNCTIONS`.
    names
        Value of each dotted name: a number or any object that supports arithmetic.
    functions
        Further functions of one argument.

    Returns
    -------
    The value, of the type that the operations return; NaN or infinite where they are not defined.

    Raises
    ------
    ConfigError
        The text is not arithmetic, or a name is unknown.
    """
    values = {**CONSTANTS, **names}
    callables = {**FUNCTIONS, **(functions or {})}
    # A dotted name may have parts that Python does not allow, such as the 0 in grid.size.0.
    dotted: list[str] = _NAME.findall(text)
    count = iter(range(len(dotted)))
    code = _NAME.sub(lambda _: f"_{next(count)}", text).strip()
    if sum(map(code.count, "+-*/(")) > _LONGEST:
        raise ConfigError(f"{excerpt(text)} has more than {_LONGEST} operations; give fewer")
    try:
        # Python takes letters for names that are none in a regular expression, such as ℘.
        code.encode("ascii")
        if "#" in code:
            raise SyntaxError("a comment would hide what follows")
        with warnings.catch_warnings():
            # Such as of 1or 2, which Python reads as 1 or 2.
            warnings.simplefilter("ignore", SyntaxWarning)
            tree = ast.parse(code, mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ConfigError(f"{excerpt(text)} is not arithmetic; write it with {_ALLOWED}") from None

    def value(node: ast.AST) -> Any:
        match node:
            case ast.Expression(body=body):
                return value(body)
            case ast.Constant(value=bool() | complex() | str() | bytes() | None):
                pass
            case ast.Constant(value=int() | float() as number):
                return np.float64(number)
            case ast.Name(id=place):
                if (name := dotted[int(place[1:])]) not in values:
                    raise ConfigError(
                        f"{excerpt(name)} in {excerpt(text)}: {nearest(name, values)}"
                    )
                return values[name]
            case ast.UnaryOp(op=op, operand=operand) if type(op) in _OPERATORS:
                return _OPERATORS[type(op)](value(operand))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
                return _OPERATORS[type(op)](value(left), value(right))
            case ast.Call(func=ast.Name(id=place), args=[argument], keywords=[]):
                if (name := dotted[int(place[1:])]) not in callables:
                    hint = nearest(name, callables)
                    raise ConfigError(
                        f"{excerpt(name)} in {excerpt(text)} is not a function; {hint}"
                    )
                return callables[name](value(argument))
        piece = ast.get_source_segment(code, node) or code
        piece = re.sub(r"\b_(\d+)\b", lambda match: dotted[int(match[1])], piece)
        raise ConfigError(f"{excerpt(piece)} in {excerpt(text)} is not allowed; write {_ALLOWED}")

    try:
        with np.errstate(all="ignore"):
            return value(tree)
    except ConfigError:
        raise
    except (TypeError, ValueError, OverflowError) as error:
        raise ConfigError(f"{excerpt(text)} cannot be evaluated: {error}") from None
