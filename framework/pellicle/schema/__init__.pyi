__all__: list[str]

from .expression import evaluate as evaluate
from .expression import names_in as names_in
from .from_file import FromFile as FromFile
from .from_file import InputPath as InputPath
from .from_file import overridden as overridden
from .from_file import paths_relative_to as paths_relative_to
from .from_file import read_toml as read_toml
from .hdf5 import fault_of_packing as fault_of_packing
from .hdf5 import fault_of_source as fault_of_source
from .hdf5 import hdf5_numbers as hdf5_numbers
from .matlab import read_mat as read_mat
from .matlab import unpacked_size as unpacked_size
from .messages import nearest as nearest
from .model import Model as Model
from .model import get as get
from .model import replace_at as replace_at
from .model import walk as walk
