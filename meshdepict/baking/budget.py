"""A budget: the best accuracy that is predicted to fit into a number of seconds."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from meshdepict.baking import costs
from meshdepict.baking.accuracy import BUDGETED
from meshdepict.baking.choices import Choices
from meshdepict.baking.machine import speed
from meshdepict.baking.plan import Step, plan
from meshdepict.baking.time_limits import as_seconds
from meshdepict.errors import MeshdepictWarning
from meshdepict.threads import thread_count

if TYPE_CHECKING:
    from meshdepict.shapes.gbuffer import GBuffer
    from meshdepict.shapes.height_field import HeightField
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.volume import Volume

__all__ = ["Predicted", "predicted_steps", "predicted_time", "within_budget"]

Look = TypeVar("Look", bound=Choices)

_HELPS = {
    "rays": "fewer rays (--set rays=16)",
    "normals": "a simplified shape, or fewer --scales",
    "lights": "fewer lights (--set lights=8)",
    "texels": "a smaller --size",
    "picture": "no --picture",
    "program": "a larger budget",
    "kernels": "a larger budget",
}


class Predicted(NamedTuple):
    """What a budget chose.

    Attributes
    ----------
    accuracy : str
    seconds : float
        By the clock, as predicted, what had been spent before among them.
    allowed : float
    """

    accuracy: str
    seconds: float
    allowed: float

    def __str__(self) -> str:
        """Return the choice in words."""
        return f"{self.accuracy}, {self.seconds:.2g} s predicted of {self.allowed:.3g} s allowed"


def within_budget(
    look: Look,
    shape: Mesh | HeightField | GBuffer | Volume,
    *,
    spent: float = 0.0,
    writes: bool = False,
    pictured: bool = False,
    texels: int = 0,
    cells: int = 0,
) -> tuple[Look, Predicted | None]:
    """Return a look with the accuracy that its budget allows, and what was predicted of it.

    The most exact one that fits, reference among them; so a larger budget is never less accurate.
    Where none fits draft is taken, and a warning says what would help. Without a budget the look
    stays, and nothing is predicted.

    Parameters
    ----------
    look : Choices
    shape : Mesh, HeightField, GBuffer or Volume
    spent : float
        Seconds that are gone already.
    writes, pictured, texels, cells
        As for `predicted_steps`.
    """
    if look.budget is None:
        return look, None
    allowed = as_seconds(look.budget)
    for accuracy in BUDGETED:
        chosen = look.replace(accuracy=accuracy, budget=None)
        steps = predicted_steps(
            shape, chosen, writes=writes, pictured=pictured, texels=texels, cells=cells
        )
        found = Predicted(accuracy, spent + predicted_time(steps), allowed)
        if found.seconds <= allowed:
            return chosen, found
    kinds: dict[str, float] = {}
    for step in steps:
        kinds[step.what] = kinds.get(step.what, 0.0) + step.seconds
    longest = max(kinds, key=kinds.__getitem__)
    helps = _HELPS.get(longest, "a simplified shape")
    if spent > allowed:
        helps = f"only a larger one, since {spent:.2g} s are gone already,"
    warnings.warn(
        f"even draft is predicted to take {found.seconds:.2g} s, more than the budget of "
        f"{allowed:.3g} s: {helps} would help",
        MeshdepictWarning,
        stacklevel=3,
    )
    return chosen, found


def predicted_time(steps: list[Step]) -> float:
    """Return the seconds by the clock that steps take on the cores that there are."""
    cores = thread_count()
    return sum(step.seconds / (cores if step.shared else 1) for step in steps)


def predicted_steps(
    shape: Mesh | HeightField | GBuffer | Volume,
    look: Choices,
    *,
    writes: bool = False,
    pictured: bool = False,
    texels: int = 0,
    cells: int = 0,
) -> list[Step]:
    """Return what is yet to be done for a shape's colours, kernels that are not loaded yet first.

    Parameters
    ----------
    shape : Mesh, HeightField, GBuffer or Volume
        Read, or a part of it.
    look : Choices
    writes, pictured : bool
        Whether a file is written, and a picture.
    texels : int
        Of a texture.
    cells : int
        Of terrain of which the shape is a part.
    """
    looks = [look.of_layer(layer) for layer in look.layers] or [look]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the bake says it
        plans = [plan(shape, each) for each in looks]
    reads = [each.reads for each in plans]
    loading = costs.loading_seconds(
        shape.kind,
        smooths=any(each.sets - {0} for each in reads),
        bends=any(each.curvature or each.seen for each in reads),
        rays=any(each.rays for each in reads),
    )
    count = _count(shape)
    times = max(cells / count, 1.0) if cells else 1.0
    steps = [Step("kernels", "loaded", loading / speed(), 0.0)]
    for each in plans:
        steps += [
            step if step.what == "tones" else step._replace(seconds=step.seconds * times)
            for step in each.steps
        ]
    if texels:
        seconds = costs.TEXEL_SECONDS * texels / speed()
        steps.append(Step("texels", f"{texels:,}", seconds, 0.0, shared=True))
    if writes:
        seconds = costs.FILE_SECONDS[shape.kind] * max(count, cells) / speed()
        steps.append(Step("file", "written", seconds, 0.0))
    if pictured:
        steps.append(Step("picture", "", costs.PICTURE_SECONDS / speed(), 0.0))
    return steps


def _count(shape: Any) -> int:
    """Return of how many samples or voxels a shape is."""
    if shape.kind == "mesh":
        return len(shape.vertices)
    if shape.kind == "height field":
        return int(shape.count)
    return int(shape.n_samples) if shape.kind == "volume" else len(shape.normals)
