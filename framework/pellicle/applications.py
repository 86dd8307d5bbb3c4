"""Names that applications bring to the top level of the package, found when they are used."""

from importlib.metadata import entry_points

GROUP = "pellicle.applications"


def __getattr__(name: str) -> object:
    for entry in entry_points(group=GROUP):
        if name in dir(application := entry.load()):
            return getattr(application, name)
    raise AttributeError(f"no application that is installed brings {name!r}")
