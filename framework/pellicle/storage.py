"""Files of results and of tables, for plugins: the public part of `pellicle.results.storage`."""

from pellicle.results.storage import read as read
from pellicle.results.storage import table as table
from pellicle.results.storage import write as write
