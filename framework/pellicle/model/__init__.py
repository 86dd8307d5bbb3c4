"""Frozen models of a configuration: error messages, dotted paths, ranges, TOML."""

from .base import Model as Model
from .from_file import FromFile as FromFile
from .input_path import AS_GIVEN as AS_GIVEN
from .input_path import InputPath as InputPath
from .input_path import as_given as as_given
from .input_path import paths_relative_to as paths_relative_to
from .messages import nearest as nearest
from .paths import replaced as replaced
