"""Entry points of packages that are not installed."""

from importlib.metadata import Distribution, EntryPoint
from pathlib import Path

from pellicle.plugins.origins import GROUP


class Installed(Distribution):
    """A distribution that exists in memory only."""

    def __init__(self, name: str, version: str) -> None:
        self.header = f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n"

    def read_text(self, filename: str) -> str | None:
        """Return the metadata; there is no other file."""
        return self.header if filename == "METADATA" else None

    def locate_file(self, path: object) -> Path:
        raise FileNotFoundError(path)


def entry_point(name: str, value: str, distribution: str, version: str) -> EntryPoint:
    """Return an entry point of a distribution."""
    entry = EntryPoint(name, value, GROUP)
    # What importlib.metadata does itself when it reads a distribution (3.11 to 3.14).
    vars(entry).update(dist=Installed(distribution, version))
    return entry
