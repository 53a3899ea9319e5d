"""Products with a parameter, such as a blind and its tilt, as one object: a data set for each of its values."""

from clerestory.system.family.family import Family, State
from clerestory.system.family.make import Planned, load
from clerestory.system.family.manifest import read, write

__all__ = ["Family", "Planned", "State", "load", "read", "write"]
