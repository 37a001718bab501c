"""Aspect shading: which way a slope faces, however gentle it is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightLike, as_light, as_view
from meshdepict.scene.vectors import in_frame
from meshdepict.scene.view import View
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["aspect"]

# Slopes less steep than this are level: float32 normals tell no direction of theirs.
_LEVEL = 1e-6


@method(source="Moellering and Kimerling 1990; Exaggerated Shading (Rusinkiewicz et al. 2006), §2")
def aspect(
    space: ScaleSpace, light: LightLike, *, view: View | str = "front", exposure: Exposure = 1.0
) -> NDArray[np.float32]:
    """Shade by the direction that a slope faces on the picture plane, not by how steep it is.

    ``½ + ½ (n_x, n_y)·l_h / ‖(n_x, n_y)‖`` in the view's frame, l_h being the light's direction on
    the picture plane: the limit of shaded relief under growing exaggeration of heights. ½ where
    the surface faces the eye, and everywhere for a light that stands at the eye.
    """
    eye = as_view(view, space.shape)
    plane = eye.frame[:2]
    towards = plane @ as_light(light, eye).direction
    slope = in_frame(space.normals_at(0), plane)
    steepness = np.linalg.norm(slope, axis=1)
    size = float(np.linalg.norm(towards))
    towards = (towards / size if size > _LEVEL else np.zeros(2)).astype(np.float32)
    sloping = steepness > _LEVEL
    cosine = np.where(
        sloping,
        (slope[:, 0] * towards[0] + slope[:, 1] * towards[1]) / np.where(sloping, steepness, 1),
        np.float32(0),
    )
    return exposed((1 + cosine) / 2, exposure)
