"""Camera-based goniophotometers: luminance pictures of screens, or of the sample itself, become scans."""

from clerestory.measure.camera.develop import Developed, Seam, develop
from clerestory.measure.camera.rig import RIGS, Rig, read_rig

__all__ = ["RIGS", "Developed", "Rig", "Seam", "develop", "read_rig"]
