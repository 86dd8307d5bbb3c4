"""Names that applications bring to the top level of the package, found when they are used."""

from importlib.metadata import entry_points

from pellicle.errors import PluginError

GROUP = "pellicle.applications"


def __getattr__(name: str) -> object:
    broken = ""
    for entry in entry_points(group=GROUP):
        try:
            application = entry.load()
        except Exception as error:
            broken += f"; that of {entry.value} cannot be used ({type(error).__name__}: {error})"
            continue
        if name in dir(application):
            return getattr(application, name)
    if broken and not name.startswith("__"):
        raise PluginError(f"no application that is installed brings pellicle.{name}{broken}")
    raise AttributeError(f"no application that is installed brings {name!r}")
