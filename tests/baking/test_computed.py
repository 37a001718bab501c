"""Only what a method reads under its options is computed: counted, beside a written list.

Every row says what a bake computes on a mesh, a volume and an image. Meshes and images climb from
each width to the next one, so that a coarse set takes all finer ones; a volume smooths each alone.
"""

from __future__ import annotations

import collections
import importlib
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
import pytest
from method_families import ON_MESHES

import meshdepict as md
from meshdepict.baking.choices import Choices
from meshdepict.baking.volumes import bake_grid
from meshdepict.curvature import grid, image, principal, view
from meshdepict.scales import bilateral, smoothing
from meshdepict.scales.grid_making import grid_space
from meshdepict.scales.grid_scales import GridSpace
from meshdepict.scales.grid_smoothing import GridSmoothing
from meshdepict.scales.image_scales import ImageSpace
from meshdepict.scales.making import scale_space
from meshdepict.scales.mesh_scales import MeshSpace
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading import METHODS, declaration, warped_occlusion
from meshdepict.transport import occlusion

KINDS = ("mesh", "volume", "image")


class Row(NamedTuple):
    """What is computed; a pair of three numbers where kinds of shapes differ."""

    sets: int | tuple[int, int, int] = 0
    curvature: int | tuple[int, int, int] = 0
    seen: int | tuple[int, int, int] = 0
    means: int = 0
    rays: int = 0

    def of(self, kind: str) -> dict[str, int]:
        numbers = ((name, getattr(self, name)) for name in self._fields)
        at = KINDS.index(kind)
        return {name: n[at] if isinstance(n, tuple) else n for name, n in numbers}


NOTHING = Row()
# An image's curvature is the view's unless told otherwise: the Hessian of its slopes, and nothing
# of the surface's own as long as all smoothed normals face the eye.
BENT = Row(sets=1, curvature=(1, 1, 0), seen=(0, 0, 1))
OWN = Row(curvature=(1, 1, 0), seen=(0, 0, 1))

COMPUTED: list[tuple[str, dict[str, Any], Row]] = [
    ("exaggerated", {}, Row(sets=9)),
    ("exaggerated", {"contrast": 0}, NOTHING),
    ("exaggerated", {"exaggeration": 0}, Row(sets=9)),
    ("exaggerated", {"principal_strength": 1}, Row(sets=9, curvature=9)),
    ("exaggerated", {"principal_strength": 1, "contrast": 0}, NOTHING),
    ("light_warping", {}, BENT),
    ("light_warping", {"magnitude": 0}, NOTHING),
    ("light_warping", {"magnitude": 0, "contrast": 0.5}, NOTHING),
    ("light_warping", {"gain": 0}, NOTHING),
    ("light_warping", {"scale": 0}, OWN),
    ("light_warping", {"scales": 4, "scale": 2}, BENT._replace(sets=(2, 1, 2))),
    ("light_warping", {"curvature": "object"}, Row(sets=1, curvature=1)),
    ("light_warping", {"curvature": "view"}, BENT._replace(seen=1)),
    ("radiance_scaling", {}, BENT),
    ("radiance_scaling", {"magnitude": 0}, NOTHING),
    ("radiance_scaling", {"magnitude": 0, "warping": 1}, BENT),
    ("radiance_scaling", {"magnitude": 0, "diffuse_magnitude": 2}, BENT),
    ("radiance_scaling", {"gain": 0}, NOTHING),
    ("radiance_scaling", {"scale": 0}, OWN),
    ("light_alignment", {}, Row(sets=5)),
    ("light_alignment", {"strength": 0}, NOTHING),
    ("light_alignment", {"strength": (0.5, 0, 0, 0, 0)}, Row(sets=1)),
    ("light_alignment", {"strength": (0.5, 0.5, 0.5, 0, 0)}, Row(sets=3)),
    ("light_alignment", {"strength": (0, 0, 0, 0, 0.5)}, Row(sets=(5, 2, 5))),
    ("light_alignment", {"strength": 0, "specular_strength": 0.3}, NOTHING),  # matt
    (
        "light_alignment",
        {"strength": 0, "specular_strength": (0.3, 0, 0, 0, 0), "material": "phong"},
        Row(sets=1),
    ),
    ("mean_curvature", {}, BENT),
    ("mean_curvature", {"gain": 0}, NOTHING),
    ("mean_curvature", {"scale": 0}, OWN),
    ("normal_enhancement", {}, Row(sets=(5, 1, 5))),
    ("normal_enhancement", {"facing": 0}, Row(sets=1)),
    ("normal_enhancement", {"amount": 0}, NOTHING),
    ("unsharp_masking", {}, Row(means=1)),
    ("unsharp_masking", {"amount": 0}, NOTHING),
    ("ambient_occlusion", {"rays": 4}, Row(rays=1)),
    ("sky_view", {"rays": 4}, Row(rays=1)),
    ("sky_view", {"rays": 4, "sky": "overhead"}, Row(rays=1)),
    ("positive_openness", {"rays": 4}, Row(rays=1)),
    ("negative_openness", {"rays": 4}, Row(rays=1)),
    ("light_warping", {"illumination": "occlusion", "rays": 4}, BENT._replace(rays=1)),
    (
        "light_warping",
        {"illumination": "occlusion", "rays": 4, "magnitude": 0},
        NOTHING._replace(rays=1),
    ),
    ("radiance_scaling", {"illumination": "occlusion", "rays": 4}, BENT._replace(rays=1)),
    ("view_curvature", {}, Row(sets=1, curvature=(1, 1, 0), seen=1)),
    ("view_curvature", {"scale": 0}, Row(curvature=(1, 1, 0), seen=1)),
]
# Who is not among them needs the shape's own normals alone.
COMPUTED += [(name, {}, NOTHING) for name in ON_MESHES if name not in {row[0] for row in COMPUTED}]

every_row = pytest.mark.parametrize(
    ("kind", "method", "options", "row"),
    [
        pytest.param(kind, *case, id=f"{kind}-{case[0]}-{case[1]}")
        for case in COMPUTED
        for kind in KINDS
        # Rays need triangles, areas a surface, and facing is about meshes.
        if (kind == "mesh" or not (case[2].rays or "facing" in case[1]))
        and (kind != "volume" or "areas" not in declaration(METHODS[case[0]]).needs)
    ],
)


@pytest.fixture
def counts(monkeypatch: pytest.MonkeyPatch) -> collections.Counter[str]:
    """Count what is costly while a test runs."""
    found: collections.Counter[str] = collections.Counter()

    def counted(known: Callable[..., Any], what: str) -> Callable[..., Any]:
        def call(*given: Any, **more: Any) -> Any:
            found[what] += 1
            return known(*given, **more)

        return call

    def count(place: Any, name: str, what: str) -> None:
        monkeypatch.setattr(place, name, counted(getattr(place, name), what))

    of_some, fill, steps = GridSmoothing.of_some, GridSmoothing.fill, bilateral.bilateral_steps

    def filled(self: GridSmoothing, width: float, *given: Any, **more: Any) -> None:
        found["sets"] += width > 0
        fill(self, width, *given, **more)

    def of_few(self: GridSmoothing, *given: Any) -> Any:
        before = found["sets"]
        result = of_some(self, *given)
        found["sets"] = before  # no set: a few samples that have no gradient at a scale
        return result

    monkeypatch.setattr(GridSmoothing, "fill", filled)
    monkeypatch.setattr(GridSmoothing, "of_some", of_few)
    monkeypatch.setattr(
        bilateral, "bilateral_steps", lambda *given, **more: counted(steps(*given, **more), "sets")
    )
    count(smoothing.NormalSums, "direction", "sets")
    count(principal, "principal_curvatures", "curvature")
    count(grid, "isosurface_curvatures", "curvature")
    count(image, "sobel_principal", "curvature")
    count(view, "view_tensor", "seen")
    count(image, "sobel_hessian", "seen")
    for space in (MeshSpace, GridSpace, ImageSpace):
        count(space, "mean", "means")
    for trace in ("ambient_openness", "sky_openness", "zenith_angles"):
        count(occlusion, trace, "rays")
    count(importlib.import_module("meshdepict.shading.sky_view"), "sky_openness", "rays")
    count(warped_occlusion, "warped_openness", "rays")
    return found


@pytest.fixture(scope="module")
def shapes() -> dict[str, Any]:
    ball = md.samples.golf_ball(600, dimples=12, depth=0.05)
    return {
        "mesh": ball,
        "volume": md.samples.ct_phantom((12, 14, 10)),
        "image": md.GBuffer.of(ball, "front", size=(40, 40)),
    }


def baked(shape: Any, method: str, options: Mapping[str, Any]) -> Any:
    sampled = shape.shape if isinstance(shape, ScaleSpace) else shape
    if sampled.kind == "volume":
        return bake_grid(shape, Choices(method, **options))
    return md.bake(shape, method, **options)


@every_row
def test_a_bake_computes_what_is_written_here(
    kind: str,
    method: str,
    options: dict[str, Any],
    row: Row,
    shapes: dict[str, Any],
    counts: collections.Counter[str],
) -> None:
    found = baked(shapes[kind], method, options)
    expected = row.of(kind)
    assert {name: counts[name] for name in expected} == expected
    counts.clear()
    baked(found.space, method, {k: v for k, v in options.items() if k not in ("scales", "facing")})
    assert counts["sets"] == counts["curvature"] == 0  # nothing twice


@every_row
def test_what_is_declared_is_what_is_read(
    kind: str, method: str, options: dict[str, Any], row: Row, shapes: dict[str, Any]
) -> None:
    found = baked(shapes[kind], method, options)
    space, reads = found.space, found.look.reads(found.space.last)
    finer = {
        scale
        for coarsest in reads.sets
        for scale in range(coarsest + 1)
        if kind != "volume" and options.get("facing") != 0
    }
    assert space.smoothed == {0} | reads.sets | finer
    facing = kind == "image"  # all of them the eye, whose curvature is enough
    assert set(space._curvatures) == (
        reads.curvature - reads.seen if facing else reads.curvature | reads.seen
    )
    assert {scale for scale, _ in space._seen} == reads.seen
    assert bool(reads.rays) == bool(row.rays)
    assert len(reads.means) == row.means


@every_row
def test_colours_are_those_of_a_full_scale_space(
    kind: str, method: str, options: dict[str, Any], row: Row, shapes: dict[str, Any]
) -> None:
    found = baked(shapes[kind], method, options)
    space = found.space
    if kind == "volume":
        full = grid_space(
            shapes[kind], space.widths, space.ratio, transfer=space.transfer,
        )  # fmt: skip
    else:
        full = scale_space(
            shapes[kind], scales=space.last, ratio=space.ratio, facing=options.get("facing", 1)
        )
    assert full.smoothed == set(range(space.last + 1))
    again = baked(full, method, {k: v for k, v in options.items() if k not in ("scales", "facing")})
    np.testing.assert_array_equal(again.intensity, found.intensity)
    np.testing.assert_array_equal(full.widths, space.widths)
    np.testing.assert_array_equal(space.normals, full.normals)  # what was missing, now
