"""Results, for plugins: the contents of `pellicle.results.result`."""

from pellicle.numerics.solution import Solution as Solution
from pellicle.numerics.solution import State as State
from pellicle.numerics.solution import Stop as Stop
from pellicle.results.result import Result as Result
from pellicle.results.result import first_message as first_message
from pellicle.results.result import load as load
from pellicle.results.status import Status as Status
from pellicle.results.variables import header as header
