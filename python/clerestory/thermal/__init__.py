"""Heat through windows: layers and gaps between two climates, U-values, solar heat gain by direction, g-values.

Optics stay outside: who asks gives what each layer absorbs of the sun.
"""

from clerestory.thermal.conditions import CONDITIONS, Conditions
from clerestory.thermal.gains import SolarGain, solar_gain, u_value
from clerestory.thermal.gas import GASES, Gas
from clerestory.thermal.layer import Gap, Openings, ThermalLayer
from clerestory.thermal.network import Balance, balance

__all__ = [
    "CONDITIONS",
    "GASES",
    "Balance",
    "Conditions",
    "Gap",
    "Gas",
    "Openings",
    "SolarGain",
    "ThermalLayer",
    "balance",
    "solar_gain",
    "u_value",
]
