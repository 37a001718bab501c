"""The kernel that makes directions of sums of normals."""

from __future__ import annotations

import math

from meshdepict.threads import kernel

__all__ = ["directions", "resultants"]


@kernel("contracted")
def resultants(sums, looking, along, least, first, last, found, mass, share):  # type: ignore[no-untyped-def]
    """Fill the resultants m = Σ A F G n of samples [first, last), their mass and their share of it.

    Parameters
    ----------
    sums : (n, c) array
        Σ A G, Σ A G n and, where F looks along a direction, xx, yy, xy, xz, yz of Σ A G n nᵀ.
    looking : (n, 3) array
        Directions; none are read where F is 1.
    along : bool
        Whether F looks along them: F(u) = (1 + u)/2.
    least : float
    found : (3, n) array
        ‖m‖ long.
    mass : (n,) array
        Σ A F G.
    share : (n,) array
        ‖m‖ of the mass, or four times that of Σ A G if it is less, not below ``least``; 1 where
        there is no mass.
    """
    for i in range(first, last):
        s = sums[i]
        m, x, y, z = float(s[0]), float(s[1]), float(s[2]), float(s[3])
        if along:
            r = looking[i]
            rx, ry, rz = float(r[0]), float(r[1]), float(r[2])
            m = (m + x * rx + y * ry + z * rz) / 2
            xx, yy, xy, xz, yz = float(s[4]), float(s[5]), float(s[6]), float(s[7]), float(s[8])
            zz = float(s[0]) - xx - yy  # the trace of Σ A G n nᵀ is Σ A G
            x, y, z = (
                (x + xx * rx + xy * ry + xz * rz) / 2,
                (y + xy * rx + yy * ry + yz * rz) / 2,
                (z + xz * rx + yz * ry + zz * rz) / 2,
            )
        found[0, i], found[1, i], found[2, i] = x, y, z
        mass[i] = m
        length = math.sqrt(x * x + y * y + z * z)
        # Sums are off by a share of Σ A G, however little of it F leaves; mostly by less than a
        # quarter of what they may be.
        share[i] = max(min(length / m, 4 * length / float(s[0])), least) if m > 0 else 1.0


@kernel("contracted")
def directions(vectors, mass, least, instead, first, last, firm):  # type: ignore[no-untyped-def]
    """Make unit vectors of resultants [first, last), and say which are none for being too short.

    Parameters
    ----------
    vectors : (3, n) array
        Changed; of what is too short, those ``instead`` where there are any.
    mass : (n,) array
    least : float
        Share of the mass that a resultant has to be longer than.
    instead : (n, 3) array
        Or no rows.
    firm : (n,) array of bool
    """
    for i in range(first, last):
        x, y, z = vectors[0, i], vectors[1, i], vectors[2, i]
        length = math.sqrt(x * x + y * y + z * z)
        firm[i] = length > least * mass[i]
        if firm[i]:
            vectors[0, i], vectors[1, i], vectors[2, i] = x / length, y / length, z / length
        elif len(instead) > 0:
            vectors[0, i], vectors[1, i], vectors[2, i] = (
                instead[i, 0],
                instead[i, 1],
                instead[i, 2],
            )
