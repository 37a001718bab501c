"""A procedural CT head in Hounsfield units: what to look at, and to measure, without a patient.

Built from signed distances in millimetres, slice by slice: x to the patient's left, y to the back,
z to the top of the head. A voxel on a border gets its share of both tissues, as in a scanner.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated

import numpy as np

from meshdepict.options import Range, check
from meshdepict.shapes.implicit import FAR, Body, Plane, Slice, cut, join
from meshdepict.shapes.volume import Volume
from meshdepict.threads import each

__all__ = ["BEADS", "ct_phantom"]


_BOX = 240.0  # mm, along every axis
_AIR, _FAT, _SKIN, _MUSCLE = -1000.0, -90.0, 60.0, 55.0
_CSF, _GREY, _WHITE = 8.0, 38.0, 28.0
_CORTICAL, _DIPLOE, _DISC, _ENAMEL, _BEAD = 1300.0, 450.0, 90.0, 2200.0, 3000.0

BEADS = {"left": (74.0, -10.0, 40.0), "front": (0.0, -83.0, 50.0), "top": (0.0, 8.0, 112.0)}
"""Centres in mm of three beads of 3000 HU and 4 mm radius on the skin, by the side that they mark.
"""

_BEAD_RADIUS = 4.0
_ORBIT = (31.0, -74.0, 0.0), (17.0, 32.0, 14.0)
_JAW = (0.0, -80.0, -88.0), (22.0, -64.0, -84.0), (40.0, -18.0, -74.0), (47.0, -4.0, -24.0)


def ct_phantom(
    size: Annotated[tuple[int, int, int], Range(2, 2048, help="voxels in x, y, z")] = (
        320,
        320,
        320,
    ),
    *,
    noise: Annotated[float, Range(0, 500, unit="HU")] = 0.0,
) -> Volume:
    """Return a CT head: skin, fat, muscle, skull with ridges and sutures, eye sockets, brain.

    Three metal beads on the skin tell left, front and top apart (`BEADS`). The box is 240 mm wide
    along every axis, about the origin; the spacing follows from `size`, and is anisotropic where
    the three numbers differ.

    Parameters
    ----------
    size : (int, int, int)
        Voxels along x, y and z.
    noise : float
        Standard deviation of white noise, the same every time.

    Returns
    -------
    Volume
        int16, in Hounsfield units.

    Raises
    ------
    MeshdepictError
        For an argument out of its range.
    """
    given = check(ct_phantom, {"size": size, "noise": noise}, "ct_phantom")
    nx, ny, nz = given["size"]
    spacing = _BOX / np.array([nx, ny, nz])
    origin = (spacing - _BOX) / 2
    x, y, z = (
        (start + step * np.arange(n)).astype(np.float32)
        for start, step, n in zip(origin, spacing, (nx, ny, nz), strict=True)
    )
    border = float(spacing.mean())
    values = np.empty((nz, ny, nx), np.int16)

    def draw(at: int) -> None:
        numbers = _Head(x, y[:, None], float(z[at]), border).head()
        if given["noise"]:
            random = np.random.default_rng((2006, at))
            numbers += given["noise"] * random.standard_normal(numbers.shape, np.float32)
        values[at] = np.clip(np.rint(numbers), -1024, 3071)

    each(draw, [(at,) for at in range(nz)])
    return Volume(
        values,
        spacing=spacing,
        origin=origin,
        hounsfield=True,
        attributes={"description": "procedural head"},
        length_unit="mm",
    )


class _Head(Slice):
    """One slice of the head: all but seams and beads is drawn on the left half, and mirrored."""

    def __init__(self, x: Plane, y: Plane, z: float, border: float) -> None:
        super().__init__(x[len(x) // 2 :], y, z, border, _AIR)
        self.all_x = x

    def mirrored(self, half: Plane) -> Plane:
        """Return both halves of what is known on the left."""
        return np.concatenate((half[:, ::-1][:, : len(self.all_x) // 2], half), axis=1)

    # --- tissues, from the outside in ---------------------------------------------------------

    def head(self) -> Plane:
        """Return the slice's numbers."""
        skin = self.skin()
        self.lay(skin, _SKIN)
        self.lay(skin + 2, _FAT)
        self.lay(skin + 4.5, _MUSCLE)
        self.throat(skin)
        self.spine()
        surface = self.skull(skin)
        self.face(skin)
        self.numbers = self.mirrored(self.numbers)
        self.x = self.all_x
        if surface is not None:
            self.lay(np.maximum(self.mirrored(surface), self.seams()), _SKIN)
        for centre in BEADS.values():
            self.lay(self.ellipsoid(centre, (_BEAD_RADIUS,) * 3), _BEAD)
        return self.numbers

    def skin(self) -> Plane:
        """Return the distance to the skin."""
        skin = self.nothing()
        join(skin, self.ellipsoid((0, 8, 28), (76, 95, 84)), 1)
        join(skin, self.ellipsoid((0, -34, -40), (60, 56, 64)), 14)
        join(skin, self.ellipsoid((0, -64, -84), (32, 27, 20)), 10)  # chin
        join(skin, self.ellipsoid((0, 24, -130), (54, 56, 130)), 14)  # neck
        cut(skin, self.ellipsoid((31, -86, 2), (16, 16, 9)), 8)
        join(skin, self.ellipsoid((31, -63, 0), (14, 13.5, 11)), 2)  # eyelids
        join(skin, self.rod((0, -78, 4), (0, -97, -30), 6), 9)  # nose
        join(skin, self.ellipsoid((8, -91, -33), (6, 9, 6)), 4)
        join(skin, self.ellipsoid((0, -88, -57), (20, 7, 3.5)), 3)  # lips
        join(skin, self.ellipsoid((0, -87, -65), (18, 7, 4)), 3)
        join(skin, self.ellipsoid((77, 16, -4), (9, 17, 29)), 4)  # ear
        cut(skin, self.ellipsoid((87, 12, -2), (6, 9, 18)), 3)
        return skin

    def throat(self, skin: Plane) -> None:
        """Lay the air from the nostrils to the windpipe."""
        nose = self.ellipsoid((0, -45, -28), (13, 48, 14))
        air = self.joined((nose, 6), (self.tube(4, 9, -24), 6))
        if air is not None:
            self.lay(np.maximum(air, skin + 5), _AIR)

    def spine(self) -> None:
        """Lay vertebrae with discs between, and the cord behind."""
        wave = float(np.cos(2 * np.pi * self.z / 18))
        self.lay(self.tube(34, 14 + 1.5 * wave, -30), _CORTICAL if wave > -0.8 else _DISC)
        self.lay(self.tube(34, 11.5 + 1.5 * wave, -32), _DIPLOE if wave > -0.8 else _DISC)
        if wave > 0 and self.z < -30:
            arch = self.joined((self.tube(54, 13, -30), 3))
            join(arch, self.rod((0, 64, self.z), (0, 80, self.z), 3), 3)
            self.lay(arch, _CORTICAL)
        self.lay(self.tube(54, 9, -30), _CSF)
        self.lay(self.tube(54, 5, -30), _GREY)

    def skull(self, skin: Plane) -> Plane | None:
        """Lay two hard tables with soft bone between, and the brain; return where seams may be."""
        outer = self.joined((self.ellipsoid((0, 8, 29), (69, 88, 77)), 1))
        if outer is None:
            return None
        join(outer, self.ellipsoid((0, 14, 30), (5, 84, 78)), 4)  # keel
        join(outer, self.ellipsoid((26, 0, 30), (38, 66, 72.5)), 3)  # temporal line
        join(outer, self.ellipsoid((25, -67, 15), (22, 10, 5)), 7)  # brow
        join(outer, self.ellipsoid((0, 88, 2), (34, 7, 4)), 6)  # nuchal ridge
        join(outer, self.ellipsoid((47, 26, -30), (9, 13, 18)), 8)  # mastoid
        orbit = self.ellipsoid(*_ORBIT)
        bone = outer.copy()
        cut(bone, orbit, 2)
        bone = np.maximum(bone, skin + 3)
        self.lay(bone, _CORTICAL)
        inner = self.joined((self.ellipsoid((0, 8, 30), (62.5, 81, 70.5)), 1))
        if inner is None:
            return None
        self.lay(np.maximum(bone + 2, 2 - inner), _DIPLOE)
        if orbit is not None:
            wall = np.maximum(np.abs(orbit.distance - 1.5) - 1.5, skin[orbit.window] + 14)
            self.lay(Body(orbit.window, wall), _CORTICAL)
            cut(inner, Body(orbit.window, orbit.distance - 3), 2)
        self.brain(inner)
        return np.maximum(np.maximum(bone, -inner), -3.5 - outer)

    def seams(self) -> Plane:
        """Return the distance to the wavy sutures between the bones of the vault."""
        x, y, z = self.x, self.y, self.z
        side, back = np.abs(x), np.where(y > 40, 0, FAR)
        coronal = np.abs(y + (20 + 0.12 * side - 1.8 * np.sin(0.7 * x))) + max(0, 20 - z)
        lambdoid = np.abs(z - 74 + 0.95 * side - 1.8 * np.sin(0.8 * side)) / 1.4 + back
        # The sagittal suture runs from the one to the other.
        ends = np.clip(-20 - y, 0, None) + np.where(y > 40, max(0, 74 - z), max(0, 40 - z))
        sagittal = np.abs(x - 1.8 * np.sin(0.7 * y)) + ends
        return np.minimum(np.minimum(coronal, sagittal), lambdoid).astype(np.float32) - 0.9

    def brain(self, inner: Plane) -> None:
        """Lay folded grey matter over white, in water."""
        x, y, z = self.x, self.y, self.z
        self.lay(inner, _CSF)
        folds = (
            np.sin(0.33 * x + 1.6 * np.sin(0.11 * y + 0.05 * z))
            + np.sin(0.35 * y + 1.6 * np.sin(0.12 * x + 0.09 * z))
            + np.sin(0.34 * z + 1.6 * np.sin(0.10 * y - 0.08 * x))
        )
        # Distance to the nearest furrow, roughly; furrows are 14 mm deep.
        furrow = 3.2 * np.abs(folds) - 1.2 + np.clip(-inner - 14, 0, None)
        cortex = np.maximum(inner + 2.5, -furrow)
        cortex = np.maximum(cortex, 1.5 - x)  # the cleft between the halves
        self.lay(cortex, _GREY)
        self.lay(np.maximum(cortex + 3.5, 3.5 - furrow), _WHITE)
        self.lay(self.ellipsoid((9, 4, 36), (5, 32, 9)), _CSF)  # ventricles

    def face(self, skin: Plane) -> None:
        """Lay jaws, cheek bones, nose, teeth and eyes."""
        jaw = self.ellipsoid((0, -54, -34), (36, 29, 23))
        bone = self.joined(
            (jaw, 1),
            (self.rod((32, -66, -17), (46, -48, -18), 5), 8),  # cheek
            (self.rod((46, -48, -18), (61, 2, -14), 3), 4),  # its arch
            *((self.rod(*ends, 6), 1) for ends in pairwise(_JAW)),
        )
        if bone is None:
            return
        cut(bone, self.ellipsoid(*_ORBIT), 2)
        join(bone, self.rod((0, -74, 8), (0, -86, -10), 4), 5)  # nose
        cut(bone, self.ellipsoid((0, -84, -27), (11, 40, 13)), 2)
        bone = np.maximum(bone, skin + 3)
        self.lay(bone, _CORTICAL)
        if jaw is not None:
            inside = np.maximum(jaw.distance, bone[jaw.window]) + 3
            self.lay(Body(jaw.window, inside), _MUSCLE)
        self.lay(self.ellipsoid((23, -54, -32), (10, 14, 11)), _AIR)  # sinus
        self.lay(self.ellipsoid((0, -52, -27), (1, 24, 13)), _CORTICAL)  # septum
        self.lay(self.ellipsoid((31, -63, 0), (11.5, 11.5, 10)), _CSF)  # eye
        for number in range(7):
            turn = 0.12 + 0.21 * number
            cx, cy = 27 * math.sin(turn), -44 - 34 * math.cos(turn)
            self.lay(self.rod((cx, cy, -50), (cx, cy, -61), 2.9), _ENAMEL)
            self.lay(self.rod((cx, cy + 1, -68), (cx, cy + 1, -80), 2.7), _ENAMEL)
