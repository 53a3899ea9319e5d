"""What a product is worth: optical figures by EN 14500, g with reference glazings, and the classes of EN 14501."""

from clerestory.rating.classes import CRITERIA, EDITIONS, Edition, Rating, classify
from clerestory.rating.optics import Optics, optics

__all__ = ["CRITERIA", "EDITIONS", "Edition", "Optics", "Rating", "classify", "optics"]
