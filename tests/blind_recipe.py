"""The recipe of a plain blind."""

BLIND = """
[sample]
kind = "venetian-blind"
pitch_mm = 72

[sample.slat]
width_mm = 80
upper = "paint"

[materials.paint]
kind = "lambertian"
reflectance = 0.5
"""
