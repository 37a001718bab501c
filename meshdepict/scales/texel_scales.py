"""The scale space of a texture: samples in the middle of texels, from those at the vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from meshdepict.scales.interpolated_scales import InterpolatedSpace

if TYPE_CHECKING:
    from meshdepict.transport.occlusion import Openness

__all__ = ["TexelSpace"]


class TexelSpace(InterpolatedSpace):
    """Samples on the faces of a mesh that cast their own rays; parameters as those of its base."""

    def _open(self, rays: int) -> Openness:
        from meshdepict.transport.occlusion import ambient_openness

        at = self.points, np.asarray(self.normals_at(0), np.float64)
        return ambient_openness(self.surface, at=at, rays=rays)
