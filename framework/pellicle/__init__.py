"""Contact mechanics of soft solids under a tensed skin.

Give an indenter, a soft material and the tension in its surface; get the contact pressure, area,
force and depth. `run` solves a `Run`, `run_study` all runs of a `Study`; `kernel`, `indenter` and
`solver` create components by type; `displacement` applies one operator. Applications that are
installed beside it add names of their own.
"""

import lazy_loader

# The public names are in __init__.pyi, which type checkers and lazy_loader read. Numpy, scipy and
# pydantic take a second to import, so a name imports its own module only.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
