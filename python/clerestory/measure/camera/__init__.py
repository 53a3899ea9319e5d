"""Camera-based goniophotometers: luminance pictures of screens, or of the sample itself, become scans."""

from clerestory.measure.camera.develop import Developed, develop
from clerestory.measure.camera.rig import RIGS, Rig, read_rig
from clerestory.measure.camera.seams import Seam

__all__ = ["RIGS", "Developed", "Rig", "Seam", "develop", "read_rig"]
