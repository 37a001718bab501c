"""Which way up a shape stands, and from where it is looked at, where nobody says.

What a file's format defines comes first, then what the shape says: what it can stand on, which of
its axes mirrors it, and what there is to see. Where the shape says nothing y is up, as meshes
usually have it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.view import named_directions
from meshdepict.surface.aspects import AXES, Aspect, aspects, footing, mirrored, spread

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Standing", "automatic_view", "standing"]

# Of the area-weighted mean normal's length: 1 for a plane, ½ for a half sphere, 0 for what is
# closed. St Helens has 0.91, a steep gorge 0.8.
_SHEET = 0.7
_CORNERS = (("front", "right"), ("front", "left"), ("back", "right"), ("back", "left"))
_SIDES = ("front", "top", "right")

# The measures of footings are added. Margins of 0.8 are as good as any, and 3 % of the surface on
# the ground count for as much as 0.18; among blocks the one with the widest base wins, the lowest.
_FIRM, _FALLEN = 0.8, -0.5
_GROUND, _GROUNDED, _WIDE, _HIGH = 0.03, 6.0, 0.5, 0.1
_STANDS = 0.32  # all that stands in its file has 0.35 and more, a head on its horns 0.28
_BETTER = 0.1  # than with y up, which meshes usually have; a ball's axes differ by 0.07
_MIRROR = 0.5  # mirror planes stand upright

_LYING = 2.0  # times the area of any side: an object that lies there is seen from above
_LOW = 1.25  # … and from above at an angle
_HIDDEN = 0.8  # of what the best corner shows: "isometric" looks at one of the four
_FACE = 0.2  # what is symmetric to the left and right looks at the eye
_USUAL = 1.05  # a side has to show more than those before it by so much, the front first


class Standing(NamedTuple):
    """How a shape is looked at.

    Attributes
    ----------
    up, view : str
    note : str
        What else it may be, where that is to be known.
    """

    up: str
    view: str
    note: str = ""


def standing(shape: Any) -> Standing:
    """Return which axis of a shape points up, and the view that shows it best.

    Of a mesh that a quarter turn lays down, the answer turns with it, unless its format decides.
    Moving and scaling it changes nothing.
    """
    if shape.kind == "height field":
        return Standing("z", "top")
    if shape.kind != "mesh":  # a patient's frame, and what an image saw
        return Standing("z" if shape.kind == "volume" else "y", "front")
    seen = _Seen(shape)
    found, second = seen.ups()
    defined = str(getattr(shape.document, "up", ""))
    if defined:
        other = found != defined and seen.stands
        note = f"{defined} is up, as its format has it: --up {found} stands it on its base"
        return Standing(defined, seen.view(defined), note if other else "")
    note = f"{found} is up, as the shape stands: --up {second} otherwise"
    return Standing(found, seen.view(found), note if found != "y" else "")


def automatic_view(shape: Any, up: str) -> str:
    """Return the view that shows a shape best whose up is known."""
    return _Seen(shape).view(up) if shape.kind == "mesh" else "front"


class _Seen:
    """What there is to see of a mesh."""

    def __init__(self, mesh: Mesh) -> None:
        points, normals = spread(mesh.unit_points, mesh.outward_faces)
        self.mean: NDArray[np.float64] = normals.mean(axis=0)
        self.sheet = bool(np.linalg.norm(self.mean) >= _SHEET)
        self.aspects = aspects(points, normals)
        self.mirrors = [mirrored(self.aspects, axis) for axis in range(3)]
        self.scores = [self._score(points, normals, number) for number in range(6)]
        self.stands = self.sheet or max(self.scores) >= _STANDS

    def _score(self, points: NDArray[Any], normals: NDArray[Any], number: int) -> float:
        foot = footing(points, normals, number)
        axis = number % 3
        upright = max(m for other, m in enumerate(self.mirrors) if other != axis)
        score = min(max(foot.margin, _FALLEN), _FIRM) - _HIGH * foot.height
        score += _GROUNDED * min(foot.flat, _GROUND) + _WIDE * foot.flat
        return score - _MIRROR * max(0.0, self.mirrors[axis] - upright)

    def ups(self) -> tuple[str, str]:
        """Return the axis that points up, and which one else may."""
        if self.sheet:  # a terrain's heights are measured along the axis that its faces look along
            axis = AXES[int(np.abs(self.mean).argmax())]
            return axis, "y" if axis != "y" else "z"
        order = sorted(range(6), key=lambda number: -self.scores[number])
        best = order[0]
        usual = AXES.index("y")
        clear = self.scores[best] >= _STANDS
        if not clear or self.scores[best] < self.scores[usual] + _BETTER:
            return "y", AXES[best if best != usual else order[1]]
        # Of two ends that are alike the positive one.
        opposite = (best + 3) % 6
        if best > opposite and self.scores[opposite] > self.scores[best] - _BETTER:
            best = opposite
        return AXES[best], AXES[usual if best != usual else order[1]]

    def view(self, up: str) -> str:
        """Return the best view with an axis up.

        A sheet is seen along the axis that its faces look along, an object that lies from above,
        what stands from the side that shows most.
        """
        if self.sheet:
            flat = {name: abs(named_directions(name, up)[0] @ self.mean) for name in _SIDES}
            return max(flat, key=lambda name: float(flat[name]))
        shown = {name: self._shown(name, up) for name in ("front", "right", "left", "back")}
        most = max(shown.values())
        best = next(name for name, value in shown.items() if _USUAL * value >= most)
        above = self._from("top", up).area
        if not most:
            return best
        level = max(self._from(name, up).area for name in shown)
        if above >= _LYING * level:
            return "top"
        corners = [shown[ahead] + shown[beside] for ahead, beside in _CORNERS]
        if above >= _LOW * level and corners[0] >= _HIDDEN * max(corners):
            return "isometric"
        return best

    def _from(self, name: str, up: str) -> Aspect:
        """Return what a named view along an axis shows."""
        towards = named_directions(name, up)[0]
        axis = int(np.abs(towards).argmax())
        return self.aspects[axis if towards[axis] > 0 else axis + 3]

    def _shown(self, name: str, up: str) -> float:
        """Return how much a view from a side shows: area and detail, more where it is symmetric."""
        towards, upwards = named_directions(name, up)
        aspect = self._from(name, up)
        across = int(np.abs(np.cross(towards, upwards)).argmax())
        face = 1 + _FACE * self.mirrors[across]
        return float(aspect.area * np.sqrt(aspect.detail)) * face
