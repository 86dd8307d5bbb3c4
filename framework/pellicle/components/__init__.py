"""The contracts of the families of components.

A component is a frozen model: its fields are its parameters in SI, each with a description; its
methods are pure. The same class defines configuration, computation, JSON schema and provenance, and
its objects can be pickled to workers. A concrete component declares
``type: Literal["name"] = "name"``.
"""

from pellicle.contact.problem import Depth as Depth
from pellicle.contact.problem import Force as Force
from pellicle.contact.time_step import Branch as Branch
from pellicle.contact.time_step import OfWave as OfWave
from pellicle.contact.time_step import have_equal_branches as have_equal_branches
from pellicle.grid import Boundary as Boundary
from pellicle.grid import boundary_of_run as boundary_of_run
from pellicle.grid import pair as pair
from pellicle.grid import shape_of_run as shape_of_run
from pellicle.plugins.component import Component as Component
from pellicle.plugins.component import role_of as role_of
from pellicle.plugins.component import words_of_type as words_of_type
from pellicle.variables import Variable as Variable

from .calls import profile_of as profile_of
from .charts import Axis as Axis
from .charts import Chart as Chart
from .charts import Column as Column
from .charts import Fields as Fields
from .charts import Look as Look
from .charts import Panel as Panel
from .charts import Series as Series
from .charts import Shown as Shown
from .charts import Table as Table
from .correction import AreaCorrection as AreaCorrection
from .executor import AnyTask as AnyTask
from .executor import Executor as Executor
from .executor import Outcome as Outcome
from .executor import Outcomes as Outcomes
from .executor import Report as Report
from .executor import Say as Say
from .executor import Task as Task
from .executor import Threads as Threads
from .executor import Work as Work
from .executor import Workers as Workers
from .indenter import ContactRadius as ContactRadius
from .indenter import Footprint as Footprint
from .indenter import ForceCurve as ForceCurve
from .indenter import HasAbelSlope as HasAbelSlope
from .indenter import HasContactRadius as HasContactRadius
from .indenter import HasForceCurve as HasForceCurve
from .indenter import HasLayerForceCurve as HasLayerForceCurve
from .indenter import Indenter as Indenter
from .indenter import LayerForceCurve as LayerForceCurve
from .installed import FromRegistry as FromRegistry
from .interaction import Interaction as Interaction
from .kernel import Isotropic as Isotropic
from .kernel import Kernel as Kernel
from .kernel import KernelOf as KernelOf
from .lattice import Lattice as Lattice
from .load import Load as Load
from .output import Output as Output
from .output import Runs as Runs
from .prescription import Prescription as Prescription
from .prescription import Search as Search
from .prescription import Setting as Setting
from .solver import IterativeSolver as IterativeSolver
from .solver import Monitor as Monitor
from .solver import Solver as Solver
from .validation import Case as Case
from .validation import Suite as Suite
