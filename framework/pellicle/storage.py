"""Files, for plugins: the contents of `pellicle.results.storage` and parts of `pellicle.files`."""

from pellicle.files import atomic_write, storage_errors
from pellicle.files import check_writable as check_writable
from pellicle.results.storage import REPLACING as REPLACING
from pellicle.results.storage import SCHEMA_VERSION as SCHEMA_VERSION
from pellicle.results.storage import append as append
from pellicle.results.storage import attributes as attributes
from pellicle.results.storage import close as close
from pellicle.results.storage import fields as fields
from pellicle.results.storage import joined as joined
from pellicle.results.storage import opened as opened
from pellicle.results.storage import read as read
from pellicle.results.storage import require_consecutive as require_consecutive
from pellicle.results.storage import scalars as scalars
from pellicle.results.storage import table as table
from pellicle.results.storage import write as write

aside = atomic_write
reported = storage_errors
