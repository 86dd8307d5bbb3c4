"""Where plugins come from, and how each is loaded on its own.

It imports nothing heavy: help texts are printed from command modules alone.
"""

from __future__ import annotations

import re
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from functools import cache
from importlib.metadata import Distribution, EntryPoint
from typing import TypeVar

from pellicle.errors import PluginError

GROUP = "pellicle"
DISABLE = "PELLICLE_DISABLE_PLUGINS"
COMMAND = "command."
"""Prefix of the names of entry points of commands."""
REMEDY = f"uninstall one, or name its distribution in {DISABLE}"
"""Remedy where several plugins claim one name."""
Loaded = TypeVar("Loaded")
# Standard output is the process's: of two threads that redirect it at once the second would restore
# what the first has redirected.
_loading = threading.RLock()


@dataclass(frozen=True)
class Origin:
    """The entry point and distribution of a plugin."""

    entry_point: str
    distribution: str
    version: str

    @classmethod
    def of(cls, entry: EntryPoint) -> Origin:
        """Return the origin of an entry point."""
        if entry.dist is None:
            return cls(entry.name, "unknown distribution", "?")
        return cls(entry.name, *_name_and_version(entry.dist))

    @property
    def is_built_in(self) -> bool:
        """Whether it is a part of pellicle."""
        return self.distribution == "pellicle"

    def __str__(self) -> str:
        return f"{self.distribution} {self.version} (entry point {self.entry_point!r})"


@dataclass(frozen=True)
class BrokenPlugin:
    """A plugin that cannot be used, and the error."""

    origin: Origin
    error: str

    def __str__(self) -> str:
        return f"{self.origin}: {self.error}"


def claimed_by(origins: Iterable[Origin]) -> str:
    """Return who claims one name, in words."""
    return f"claimed by {' and by '.join(map(str, origins))}"


def in_order(entries: Iterable[EntryPoint], disable: str) -> Iterator[tuple[EntryPoint, bool]]:
    """Yield each entry point once, by name, and whether the value of `DISABLE` switches it off."""
    named = {_same(name) for name in disable.split(",")} - {""}
    for entry in sorted(set(entries), key=lambda entry: (entry.name, entry.value)):
        is_off = False
        if named and not (origin := Origin.of(entry)).is_built_in:
            names = _same(origin.distribution), _same(origin.entry_point)
            is_off = not named.isdisjoint({"1", "true", "all", *names})
        yield entry, is_off


def call_isolated(entry: EntryPoint, load: Callable[[], Loaded]) -> Loaded | BrokenPlugin:
    """Return what a function that runs code of the plugin of an entry point returns, or the error.

    Parsers of arguments and checks of licences call sys.exit(). What the plugin prints goes to
    standard error: commands print JSON to standard output.
    """
    try:
        with _loading, redirect_stdout(sys.stderr):
            return load()
    except (Exception, SystemExit) as error:
        kind = "" if isinstance(error, PluginError) else f"{type(error).__name__}: "
        return BrokenPlugin(Origin.of(entry), f"{kind}{error}".removesuffix(": "))


@cache
def _name_and_version(distribution: Distribution) -> tuple[str, str]:
    """Return what the metadata of a distribution say, which are parsed at each access."""
    metadata = distribution.metadata
    return metadata["Name"], metadata["Version"]


def _same(name: str) -> str:
    """Return the normalised name: package indexes treat my_plugin and My-Plugin as equal."""
    return re.sub(r"[-_.]+", "-", name.strip()).lower()
