"""A window as a light source: candle power under a sky, files of lighting design, and the daylight that it supplies."""

from clerestory.luminaire import eulumdat, lm63
from clerestory.luminaire.candle_power import Beam, CandlePower, candle_power
from clerestory.luminaire.facade import Facade
from clerestory.luminaire.supply import Supply, daylight_supply

__all__ = ["Beam", "CandlePower", "Facade", "Supply", "candle_power", "daylight_supply", "eulumdat", "lm63"]
