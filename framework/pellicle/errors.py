"""Errors; every message names the field, the value and the remedy."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from typing import NamedTuple

_TOLD, _PATH = 10, 200
"""Problems that a message tells, and letters of the path of a field."""


def excerpt(value: object) -> str:
    """Return ``value`` as text for a message, at most 60 characters long."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}…"


def first_of(texts: Sequence[str]) -> str:
    """Return the first text and the number of others, such as "step 3 and 2 more"."""
    return f"{texts[0]} and {len(texts) - 1} more" if len(texts) > 1 else texts[0]


class PellicleError(Exception):
    """Base class of all errors that pellicle raises on purpose."""


class Problem(NamedTuple):
    """One problem of a configuration."""

    field: str
    """Dotted path of the field, e.g. ``kernel.tension``; empty for the whole configuration."""
    message: str
    """The value, the allowed values and the remedy."""

    def __str__(self) -> str:
        field = self.field if len(self.field) <= _PATH else f"{self.field[: _PATH - 1]}…"
        return f"{field}: {self.message}" if field else self.message


class ConfigError(PellicleError, ValueError):
    """A configuration, or an argument of the library, that cannot be used.

    Parameters
    ----------
    problems
        All problems, or one message.
    field
        Dotted path of the field of a single message.
    """

    def __init__(self, problems: Iterable[Problem] | str, field: str = "") -> None:
        self.problems: tuple[Problem, ...] = (
            (Problem(field, problems),) if isinstance(problems, str) else tuple(problems)
        )
        told, more = self.problems[:_TOLD], len(self.problems) - _TOLD
        ending = [f"and {more} more"] if more > 0 else []
        super().__init__("\n".join([*map(str, told), *ending]))

    def __reduce__(self) -> tuple[type[ConfigError], tuple[tuple[Problem, ...]]]:
        return type(self), (self.problems,)

    def within(self, field: str) -> ConfigError:
        """Return the same problems with ``field`` before their paths."""
        return type(self)(
            Problem(f"{field}.{inner}" if inner else field, message)
            for inner, message in self.problems
        )


@contextmanager
def problems_within(field: str) -> Iterator[None]:
    """Put ``field`` before the paths of the problems of a `ConfigError` that the block raises."""
    try:
        yield
    except ConfigError as error:
        raise error.within(field) from None


@contextmanager
def all_problems() -> Iterator[Callable[[str], AbstractContextManager[None]]]:
    """Raise the problems of all blocks ``with within(field):`` in one error at the end."""
    problems: list[Problem] = []

    @contextmanager
    def within(field: str) -> Iterator[None]:
        try:
            yield
        except ConfigError as error:
            problems.extend((error.within(field) if field else error).problems)
        except ValueError as error:
            problems.append(Problem(field, str(error)))

    yield within
    if problems:
        raise ConfigError(problems)


class PluginError(PellicleError):
    """A plugin is broken, two plugins claim one type, or a component breaks its contract."""


class ConvergenceError(PellicleError):
    """A result of the required accuracy cannot be computed."""


class StorageError(PellicleError):
    """A result file or folder that cannot be read or written."""


class ConvergenceWarning(UserWarning):
    """A step of a run is marked as not converged or too coarse; its numbers are kept."""
