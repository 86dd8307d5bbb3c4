"""Contact mechanics of soft solids under a tensed skin.

Give an indenter, a soft material and the tension in its surface; get the contact pressure, area,
force and depth. `run` solves a `Run`, `run_study` all runs of a `Study`; `kernel`, `indenter` and
`solver` make components by name; `displacement` applies one operator; `fit` finds modulus and
tension of a measured curve, `fit_many` and `fit_pooled` those of many.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .components import (
        AreaCorrection,
        Case,
        Executor,
        ForceCurve,
        HasForceCurve,
        Indenter,
        IterativeSolver,
        Kernel,
        Output,
        Place,
        Solver,
    )
    from .config import Run
    from .errors import (
        ConfigError,
        ConvergenceError,
        ConvergenceWarning,
        PellicleError,
        PluginError,
        StorageError,
    )
    from .fitting.estimate import Estimate
    from .fitting.fit import Fit, fit
    from .fitting.many import fit_many
    from .fitting.pooled import PooledCurve, PooledFit, fit_pooled
    from .grid import Grid
    from .hookspecs import hookimpl
    from .loading import Loading
    from .operators import displacement
    from .orchestrator import run
    from .plugins import registry
    from .problem import Problem
    from .result import Result, Solution, Status, Stop, load
    from .study import run_study
    from .study_config import Study, schema
    from .validation import validate

# Numpy, scipy and pydantic take a second to import; a name pays for its own module only.
_HOME = {
    "AreaCorrection": "components",
    "Case": "components",
    "ConfigError": "errors",
    "ConvergenceError": "errors",
    "ConvergenceWarning": "errors",
    "Estimate": "fitting.estimate",
    "Executor": "components",
    "Fit": "fitting.fit",
    "ForceCurve": "components",
    "Grid": "grid",
    "HasForceCurve": "components",
    "Indenter": "components",
    "IterativeSolver": "components",
    "Kernel": "components",
    "Loading": "loading",
    "Output": "components",
    "PellicleError": "errors",
    "Place": "components",
    "PluginError": "errors",
    "PooledCurve": "fitting.pooled",
    "PooledFit": "fitting.pooled",
    "Problem": "problem",
    "Result": "result",
    "Run": "config",
    "Solution": "result",
    "Solver": "components",
    "Status": "result",
    "Stop": "result",
    "StorageError": "errors",
    "Study": "study_config",
    "displacement": "operators",
    "fit": "fitting.fit",
    "fit_many": "fitting.many",
    "fit_pooled": "fitting.pooled",
    "hookimpl": "hookspecs",
    "load": "result",
    "registry": "plugins",
    "run": "orchestrator",
    "run_study": "study",
    "schema": "study_config",
    "validate": "validation",
}

__all__ = [
    "AreaCorrection",
    "Case",
    "ConfigError",
    "ConvergenceError",
    "ConvergenceWarning",
    "Estimate",
    "Executor",
    "Fit",
    "ForceCurve",
    "Grid",
    "HasForceCurve",
    "Indenter",
    "IterativeSolver",
    "Kernel",
    "Loading",
    "Output",
    "PellicleError",
    "Place",
    "PluginError",
    "PooledCurve",
    "PooledFit",
    "Problem",
    "Result",
    "Run",
    "Solution",
    "Solver",
    "Status",
    "Stop",
    "StorageError",
    "Study",
    "__version__",
    "displacement",
    "fit",
    "fit_many",
    "fit_pooled",
    "hookimpl",
    "indenter",
    "kernel",
    "load",
    "registry",
    "run",
    "run_study",
    "schema",
    "solver",
    "validate",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("pellicle")
    if name == "analysis":
        return import_module(".analysis", __name__)
    if name not in _HOME:
        raise AttributeError(f"module 'pellicle' has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)


def __dir__() -> list[str]:
    return __all__


def kernel(type: str, /, **fields: Any) -> Kernel:  # noqa: A002 - the name of the field
    """Return a kernel by its type, e.g. ``kernel("half_space", reduced_modulus="10 kPa")``.

    Raises
    ------
    ConfigError
        No such type, or fields that it does not allow.
    """
    from . import components, config

    return config.component(components.Kernel, type, fields)


def indenter(type: str, /, **fields: Any) -> Indenter:  # noqa: A002 - the name of the field
    """Return an indenter by its type, e.g. ``indenter("sphere", radius="5 um")``.

    Raises
    ------
    ConfigError
        No such type, or fields that it does not allow.
    """
    from . import components, config

    return config.component(components.Indenter, type, fields)


def solver(type: str, /, **fields: Any) -> Solver:  # noqa: A002 - the name of the field
    """Return a solver by its type, e.g. ``solver("conjugate_gradient", tolerance=1e-6)``.

    Raises
    ------
    ConfigError
        No such type, or fields that it does not allow.
    """
    from . import components, config

    return config.component(components.Solver, type, fields)
