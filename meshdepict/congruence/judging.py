"""Congruence: how well a shading's flow follows the flow of the shape (Local Light Alignment, §7).

Both flows are read from pictures of one view: the structure tensors of the shading and of the
depth, or of the slope. A score of 1 says that the shading's bands run along those of the shape
everywhere and are as marked; 0, that it shows nothing of the shape.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.congruence.contours import connected, whole_windows
from meshdepict.congruence.estimated_normals import estimated_normals
from meshdepict.congruence.picture_input import checked_mask, checked_normals, checked_picture
from meshdepict.congruence.structure_tensor import StructureTensor, reach, structure_tensor
from meshdepict.errors import MeshdepictError

__all__ = ["Flows", "Judge", "ShapeFlow", "check_flow", "flows", "picture", "score"]

ShapeFlow = Literal["depth", "slope"]
"""What the shape's flow is read from: see `Judge`."""

Floats = NDArray[np.floating[Any]]
Mask = NDArray[np.bool_]

_GRADIENT_WIDTH, _TENSOR_WIDTH = 1.0, 5.0  # pixels
# A pixel counts where everything that its tensor takes in, 3 widths of both Gaussians, is object:
# 18 pixels to each side. Nothing beyond the object can change a score, then.
_REACH = reach(_GRADIENT_WIDTH) + reach(_TENSOR_WIDTH)
_WINDOW = 2 * _REACH + 1
_TOP = 99  # the percentile of the energies that counts as 1
_ROUNDING = 1e-12  # of an image in double precision, relative
_NORMAL_ROUNDING = 1e-6  # of unit normals, which are in single precision

_POOR_TO_GOOD = ((178, 24, 32), (240, 130, 70), (252, 240, 190), (110, 166, 208), (36, 66, 148))


class Flows(NamedTuple):
    """What a congruence score is made of, each a picture; zero where no pixel counts.

    Directions point across the bands: x to the right, y down; either sign means the same.
    """

    shape_direction: NDArray[np.float32]  # (h, w, 2) unit; zero where the depth hardly varies
    shading_direction: NDArray[np.float32]  # (h, w, 2) unit; zero where the shading hardly varies
    shape_energy: NDArray[np.float32]  # (h, w) e_c in [0, 1], the weight of a pixel
    shading_energy: NDArray[np.float32]  # (h, w) e_s ≥ 0; 1 is as marked as frontal Lambert's top
    counted: Mask  # (h, w) the pixels that count
    congruence: NDArray[np.float32]  # (h, w) in [0, 1], the score of each pixel
    score: float  # their mean, weighted by shape_energy


def score(
    shading: ArrayLike,
    depth: ArrayLike,
    mask: ArrayLike,
    *,
    reference: ArrayLike | None = None,
    flow: ShapeFlow = "depth",
    normals: ArrayLike | None = None,
) -> float:
    """Return the congruence of one shading with the shape: a number from 0 to 1.

    Parameters
    ----------
    shading : (h, w) or (h, w, 3) array_like of float
        Linear values (before sRGB); colours count by their luminance.
    depth : (h, w) array_like of float
        Along the line of sight, in any unit, from anywhere, either sign.
    mask : (h, w) array_like of bool
        Where the picture shows the object. Values elsewhere don't matter; they may be NaN.
    reference : (h, w) or (h, w, 3) array_like of float, optional
        The plain Lambertian shading of the same view under a frontal light, in linear values: how
        marked its bands are is what counts as 1. Unless given, it is estimated from the depth
        (see `Judge`).
    flow : {"depth", "slope"}
        What the shape's flow is read from: the depth, as in the paper, or how the surface tilts.
    normals : (h, w, 3) array_like of float, optional
        Of the surface, for ``flow="slope"``: x to the right, y up or down, z along the line of
        sight, of any length. Unless given, they are estimated from the depth, in the unit that the
        reference is estimated in.

    Raises
    ------
    MeshdepictError
        For pictures of different sizes or too small for one window (37 × 37 pixels), an empty
        mask, 8-bit values, NaN or infinity inside the mask, another flow, normals of no length,
        and normals that no flow reads.

    Notes
    -----
    ``Σ e_c (1 − clamp(e_c − e_s)) |v_c·v_s| / Σ e_c`` (eq. 2), with v the main direction and e
    the energy of the structure tensors (gradients at 1 pixel, averaged at 5) of depth (c) and
    shading (s). e_c is divided by its 99th percentile and cut at 1, e_s divided by that of the
    reference. Summed are the pixels whose window, 18 pixels to each side, holds nothing but object
    and no occluding contour. Without such pixels, or on a flat depth, the score is 0.

    With ``flow="slope"`` c is a picture of two numbers, the slope g of the depth as g/√(1 + ‖g‖²):
    x and y of the unit normal, whose tensors add up. v_c then points the way in which the surface
    bends most, not that in which it leans, and e_c is large where it bends, not where it is steep;
    a plane scores 0. Where it bends alike in all directions, as a smooth ball, v_c is x.
    """
    judge = Judge(depth, mask, reference=reference, flow=flow, normals=normals)
    return judge.score(shading)


def flows(
    shading: ArrayLike,
    depth: ArrayLike,
    mask: ArrayLike,
    *,
    reference: ArrayLike | None = None,
    flow: ShapeFlow = "depth",
    normals: ArrayLike | None = None,
) -> Flows:
    """Return what the `score` is made of; parameters as there."""
    judge = Judge(depth, mask, reference=reference, flow=flow, normals=normals)
    return judge.flows(shading)


class Judge:
    """The shape flow of one view, to score any number of shadings by.

    Parameters
    ----------
    depth, mask, reference, flow, normals
        As in `score`. An estimated reference is the frontal Lambertian shading of the depth itself.
        A depth image alone doesn't say how steep it is, so its unit is taken such that the root
        mean square slope is 0.8. Six views of scans of whole objects had 0.66 to 0.92, and the
        estimate came out 5 to 34 % too marked; the real shadings of a shallow relief it underrates.

    Attributes
    ----------
    counted : (h, w) array of bool
        The pixels that count.
    """

    counted: Mask

    def __init__(
        self,
        depth: ArrayLike,
        mask: ArrayLike,
        *,
        reference: ArrayLike | None = None,
        flow: ShapeFlow = "depth",
        normals: ArrayLike | None = None,
    ) -> None:
        check_flow(flow)
        if normals is not None and flow != "slope":
            raise MeshdepictError(
                f"flow={flow!r} reads no normals: leave them out, or choose flow='slope'"
            )
        self._mask = checked_mask(mask, smallest=_WINDOW)
        depths = checked_picture(depth, "depth", self._mask, color=False)
        [heights], _ = _centred([depths], self._mask)
        across, down = (connected(heights, self._mask, axis) for axis in (1, 0))
        self.counted = whole_windows(self._mask, across, down, reach=_REACH)
        self._box = _surroundings(self.counted)
        facing: Floats
        if normals is not None:
            facing = checked_normals(normals, self._mask)
        elif flow == "slope" or reference is None:
            facing = estimated_normals(heights, across, down, self.counted)
        if flow == "slope":
            rounding = _ROUNDING if normals is None else _NORMAL_ROUNDING
            shape_flow = self._flow(facing[..., 0], facing[..., 1], rounding=rounding)
        else:
            shape_flow = self._flow(heights)
        self._direction = shape_flow.direction
        self._energy = np.minimum(shape_flow.scaled(shape_flow.contrast), 1)
        if reference is None:
            frontal = np.abs(facing[..., 2])
        else:
            frontal = checked_picture(reference, "reference", self._mask)
        self._contrast = self._flow(frontal).contrast if self._energy.any() else 0.0

    def score(self, shading: ArrayLike) -> float:
        """Return the congruence of one shading, in [0, 1]; see the function `score`."""
        flow = self._flow(checked_picture(shading, "shading", self._mask))
        return self._mean(self._congruence(flow))

    def flows(self, shading: ArrayLike) -> Flows:
        """Return what the score of one shading is made of."""
        flow = self._flow(checked_picture(shading, "shading", self._mask))
        congruence = self._congruence(flow)
        return Flows(
            self._as_picture(self._direction),
            self._as_picture(flow.direction),
            self._as_picture(self._energy),
            self._as_picture(flow.scaled(self._contrast)),
            self.counted.copy(),
            self._as_picture(congruence),
            self._mean(congruence),
        )

    def _flow(self, *channels: Floats, rounding: float = _ROUNDING) -> _Flow:
        """Return direction and energy of all channels of an image at the pixels that count."""
        inside = self._mask[self._box]
        images, amplitude = _centred([c[self._box] for c in channels], inside, rounding=rounding)
        inner = self.counted[self._box][_REACH:-_REACH, _REACH:-_REACH]
        total = np.zeros((3, int(inner.sum())))
        for image in images:
            planes = structure_tensor(image, gradient_width=_GRADIENT_WIDTH, width=_TENSOR_WIDTH)
            total += [plane[inner] for plane in planes]
        tensor = StructureTensor(*total)
        return _Flow(tensor.direction, tensor.energy, amplitude)

    def _congruence(self, flow: _Flow) -> Floats:
        """Return the score of every pixel that counts."""
        if not self._contrast:
            return np.zeros(len(flow.energy))
        missing = np.clip(self._energy - flow.scaled(self._contrast), 0, 1)
        along = np.abs(np.sum(self._direction * flow.direction, axis=1))
        return (1 - missing) * np.minimum(along, 1)

    def _mean(self, congruence: Floats) -> float:
        total = self._energy.sum()
        return min(float(np.sum(self._energy * congruence) / total), 1.0) if total else 0.0

    def _as_picture(self, values: Floats) -> NDArray[np.float32]:
        image = np.zeros((*self.counted.shape, *values.shape[1:]), np.float32)
        image[self.counted] = values
        return image


class _Flow(NamedTuple):
    """Direction (k, 2) and energy (k,) of an image divided by its amplitude."""

    direction: Floats
    energy: Floats
    amplitude: float

    @property
    def contrast(self) -> float:
        """Root of the energy that is to count as 1, in the image's own unit."""
        if not len(self.energy):
            return 0.0
        return self.amplitude * float(np.percentile(self.energy, _TOP)) ** 0.5

    def scaled(self, contrast: float) -> Floats:
        """Return the energies so that those of this contrast are 1; zero where it is zero."""
        if not contrast:
            return np.zeros_like(self.energy)
        return self.energy * min(self.amplitude / contrast, 1e15) ** 2  # finite whatever comes


def check_flow(flow: str) -> None:
    """Refuse what the shape's flow can't be read from."""
    if flow not in get_args(ShapeFlow):
        raise MeshdepictError(f"flow={flow!r} is none of {', '.join(get_args(ShapeFlow))}")


def picture(flows: Flows) -> NDArray[np.uint8]:
    """Return the score image: red where the shading fails the shape, blue where it follows.

    Returns
    -------
    (h, w, 4) array of uint8
        sRGB and opacity; transparent where no pixel counts.
    """
    places = np.linspace(0, 1, len(_POOR_TO_GOOD))
    table = [
        np.interp(np.arange(256) / 255, places, ends) for ends in zip(*_POOR_TO_GOOD, strict=True)
    ]
    colors = np.stack(table, axis=1).round().astype(np.uint8)
    levels = (flows.congruence * 255 + 0.5).astype(np.uint8)
    image = np.zeros((*levels.shape, 4), np.uint8)
    image[..., :3] = colors[levels]
    image[..., 3] = 255
    image[~flows.counted] = 0
    return image


def _centred(
    channels: Sequence[Floats], mask: Mask, *, rounding: float = _ROUNDING
) -> tuple[list[Floats], float]:
    """Return the channels of an image in [−1, 1] over the mask, 0 elsewhere, and half their range.

    All are 0 for an image that is constant but for rounding, which has no flow to be found.
    """
    lows = [float(np.min(image, where=mask, initial=np.inf)) for image in channels]
    highs = [float(np.max(image, where=mask, initial=-np.inf)) for image in channels]
    # Halves, so that nothing can overflow.
    amplitude = max(high / 2 - low / 2 for low, high in zip(lows, highs, strict=True))
    if not amplitude > rounding * max(map(abs, lows + highs)):
        return [np.zeros_like(image) for image in channels], 0.0
    return [
        np.where(mask, (image - (low / 2 + high / 2)) / amplitude, 0.0)
        for image, low, high in zip(channels, lows, highs, strict=True)
    ], amplitude


def _surroundings(counted: Mask) -> tuple[slice, slice]:
    """Return the part of the picture that the windows of the pixels that count cover."""
    if not counted.any():
        return slice(0, _WINDOW), slice(0, _WINDOW)  # one window, whose centre doesn't count
    ends = (np.flatnonzero(counted.any(axis=axis))[[0, -1]] for axis in (1, 0))
    rows, columns = (slice(int(a) - _REACH, int(b) + _REACH + 1) for a, b in ends)
    return rows, columns
