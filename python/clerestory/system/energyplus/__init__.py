"""Windows for EnergyPlus, as `Construction:ComplexFenestrationState` with all that it refers to."""

from clerestory.system.energyplus.objects import Object, fenestration
from clerestory.system.energyplus.text import epjson, idf

__all__ = ["Object", "epjson", "fenestration", "idf"]
