"""What a data set says of its product besides light: its layers, heat, control curve, and how it is to be placed."""

from clerestory.system.product.data import Curve, Heat, Orientation, ProductData
from clerestory.system.product.keys import OrientationKeys, ProductKeys
from clerestory.system.product.xml import product_of, with_product

__all__ = [
    "Curve",
    "Heat",
    "Orientation",
    "OrientationKeys",
    "ProductData",
    "ProductKeys",
    "product_of",
    "with_product",
]
