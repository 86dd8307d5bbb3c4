"""Contact mechanics of soft solids under a tensed skin.

Give an indenter, a soft material and the tension in its surface; get the contact pressure, area,
force and depth. `run` solves a `Run`, `run_study` all runs of a `Study`; `kernel`, `indenter` and
`solver` make components by name; `displacement` applies one operator; `fit` finds modulus and
tension of a measured curve, `fit_many` and `fit_pooled` those of many.
"""

import lazy_loader

# The public names stand in __init__.pyi, for type checkers and for this. Numpy, scipy and pydantic
# take a second to import: a name pays for its own module only.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
