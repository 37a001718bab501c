"""From a shading's values to the colours on the screen, as `color.encode` has them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.colormaps import colormap as color_table

if TYPE_CHECKING:
    from meshdepict.drawing.shader import Uniforms

__all__ = ["GLSL", "table_uniforms"]

# A colour map of 256 colours is 64 vectors: each number holds one colour, 8 bits a channel. Were
# every one a vector of its own, the map alone would fill what uniforms some cards promise.
GLSL = """
float displayed(float x) {
#ifdef LINEAR
  return x <= 0.00313066844 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
#else
  return x;
#endif
}

vec3 encoded(vec3 value) {
  vec3 x = clamp(exposure * value, 0.0, 1.0);
  x = vec3(displayed(x.r), displayed(x.g), displayed(x.b));
#ifdef MAPPED
  int level = int(255.0 * x.r + 0.5);
  float color = colors[level / 16][(level / 4) % 4][level % 4];
  x = floor(mod(vec3(color / 65536.0, color / 256.0, color), 256.0)) / 255.0;
#endif
  return x;
}
"""


def table_uniforms(name: str | None) -> Uniforms:
    """Return the colour map as uniforms; none for grey.

    Raises
    ------
    MeshdepictError
        For an unknown name.
    """
    if name is None:
        return {}
    red, green, blue = color_table(name).astype(np.int64).T
    packed: NDArray[np.float64] = (red * 65536 + green * 256 + blue).astype(np.float64)
    return {"colors": packed.reshape(16, 4, 4)}
