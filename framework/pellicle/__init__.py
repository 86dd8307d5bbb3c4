"""Contact mechanics of soft solids under a tensed skin.

Give an indenter, a soft material and the tension in its surface; get the contact pressure, area,
force and depth. `run` solves a `Run`, `run_study` all runs of a `Study`; `kernel`, `indenter` and
`solver` make components by name; `displacement` applies one operator; `fit` finds modulus and
tension of a measured curve, `fit_many` and `fit_pooled` those of many.
"""

import lazy_loader

# The public names stand in __init__.pyi, for type checkers and for this. Numpy, scipy and pydantic
# take a second to import: a name pays for its own module only.
_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    if name == "Place":
        # Raises what a plugin of an earlier version has to be told.
        from .components import Place  # noqa: F401
    return _public(name)
