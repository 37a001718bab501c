"""Unit normals as points of an unfolded octahedron, 2 × 16 bits each, three to an attribute.

Meyer et al., On Floating-Point Normal Vectors, EGSR 2010: n / (|x| + |y| + |z|) lies on an
octahedron, whose lower half is folded out to fill the square [−1, 1]². Its coordinates are rounded
to 2¹⁶ − 1 steps; of the four places around a normal that one is taken which turns it least. Over
ten million random normals the largest error was 4.4e-5 rad and the root mean square 2.3e-5 rad;
normals are smoothed to 1e-4 rad. The six axes are exact.

VTK passes attributes on as float32, which hold integers of 24 bits: the four numbers of an
attribute hold exactly three normals. So 14 sets (13 scales) take 5 of the 16 attributes that
every card has, and the 15 that the position leaves hold 45.

Where a method magnifies errors, 2 × 24 bits hold two normals in an attribute: 14 sets take 7, and
the largest error is 4.1e-7 rad, most of it the shader's own single precision.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["fold", "most_sets", "pack_normals", "unfold", "unpacking"]

_PER_ATTRIBUTE = {16: 3, 24: 2}
_ATTRIBUTES = 15  # the position is the sixteenth


def fold(normals: ArrayLike, *, bits: int = 16) -> NDArray[np.float32]:
    """Return the places (n, 2) of unit normals (n, 3) in the square, whole numbers 0 … 2ᵇ − 2."""
    from meshdepict.viewer.live.octahedral_kernel import nearest_places

    return nearest_places(np.asarray(normals, np.float32), _half(bits))


def unfold(places: ArrayLike, *, bits: int = 16) -> NDArray[np.float64]:
    """Return the unit normals (…, 3) that stand for places (…, 2): what the shader computes."""
    p = np.asarray(places, np.float64) / _half(bits) - 1
    z = 1 - np.abs(p).sum(axis=-1, keepdims=True)
    p = np.where(p < 0, p + np.maximum(-z, 0), p - np.maximum(-z, 0))
    n = np.concatenate((p, z), axis=-1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


def most_sets(bits: int) -> int:
    """Return how many sets of normals fit in the attributes."""
    return _ATTRIBUTES * _PER_ATTRIBUTE[bits]


def pack_normals(sets: ArrayLike, *, bits: int = 16) -> list[NDArray[np.float32]]:
    """Return attributes (n, 4) that hold sets of unit normals.

    Parameters
    ----------
    sets : (k, n, 3) array_like
    bits : {16, 24}
        Of a coordinate.

    Returns
    -------
    list of (n, 4) array of float32
        Whole numbers below 2²⁴. Of 24 bits: the places of two normals. Of 16: these in the upper
        16 bits of the four, and the place of a third in their lower 8 bits.
    """
    sets = np.asarray(sets)
    share = _PER_ATTRIBUTE[bits]
    packed = []
    for first in range(0, len(sets), share):
        places = [fold(one, bits=bits) for one in sets[first : first + share]]
        places += [np.zeros_like(places[0])] * (share - len(places))
        numbers = np.concatenate(places[:2], axis=1)
        if bits == 16:
            upper, lower = np.divmod(places[2], np.float32(256))
            numbers *= 256
            numbers += np.stack((upper[:, 0], lower[:, 0], upper[:, 1], lower[:, 1]), axis=1)
        packed.append(numbers)
    return packed


def unpacking(sets: int, *, bits: int = 16) -> str:
    """Return the GLSL that declares `normals0` … and whose ``unpack()`` writes ``vec3 n[sets]``."""
    share = _PER_ATTRIBUTE[bits]
    count = -(-sets // share)
    lines = []
    for a in range(count):
        places = [f"normals{a}.xy", f"normals{a}.zw"]
        if bits == 16:
            lines += [f"upper = floor(normals{a} / 256.0);", f"lower = normals{a} - 256.0 * upper;"]
            places = ["upper.xy", "upper.zw", "256.0 * lower.xz + lower.yw"]
        lines += [
            f"n[{k}] = unfold({place});"
            for k, place in enumerate(places, start=a * share)
            if k < sets
        ]
    declared = "".join(f"in vec4 normals{a};\n" for a in range(count))
    body = "\n  ".join(lines)
    return f"""{declared}
vec3 n[{sets}];

vec3 unfold(vec2 place) {{
  vec2 p = place / {_half(bits)}.0 - 1.0;
  float z = 1.0 - abs(p.x) - abs(p.y);
  float below = max(-z, 0.0);
  return normalize(vec3(p.x < 0.0 ? p.x + below : p.x - below,
                        p.y < 0.0 ? p.y + below : p.y - below, z));
}}

void unpack() {{
  vec4 upper, lower;
  {body}
}}
"""


def _half(bits: int) -> int:
    """Return the steps from the middle of the square to its edge."""
    return int(2 ** (bits - 1)) - 1
