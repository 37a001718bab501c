"""Rays through a volume: VTK's ray caster with colour and light taken where the ray passes.

VTK finds the rays and marches along them, a voxel at a time. What it would do with a sample is
replaced: the CT number interpolated there is classified by a table of linear colour and opacity,
and the colour is multiplied by the light there, in linear light. Where matter begins or ends within
a step, and inside of it, the step is divided; empty blocks are leapt over.

The table reaches the card as VTK's "two-dimensional transfer function", an ordinary texture of four
floats a texel. After colours and opacities it holds how far from matter each block is, and then
what else the light needs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.drawing.empty_space import BLOCK, clearance
from meshdepict.errors import MeshdepictError

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkVolume
    from vtkmodules.vtkRenderingVolume import vtkGPUVolumeRayCastMapper

    from meshdepict.shapes.data_set import ImageData
    from meshdepict.voxels.grid import Grid, Triple

__all__ = ["LEVELS", "march", "ray_caster", "refill", "volume_actor"]

LEVELS = 1024
"""Levels that have a colour and an opacity of their own; between them lie straight lines."""

_SIDES = (1024, 2048, 4096, 8192, 16384)  # of textures that every card has

_PARTS = 4  # of a step where there is something: edges a quarter of a voxel apart

_TABLE = f"""
vec4 table_at(int place) {{
  return texelFetch(in_transfer2D_0[0], ivec2(place & (TABLE_WIDTH - 1), place / TABLE_WIDTH), 0);
}}

// Linear colour, and opacity per voxel.
vec4 classified(float level) {{
  float place = clamp(level, 0.0, 1.0) * {LEVELS - 1}.0;
  int first = min(int(place), {LEVELS - 2});
  return mix(table_at(first), table_at(first + 1), place - float(first));
}}

vec3 decoded(vec3 x) {{
  return mix(x / 12.92, pow((x + 0.055) / 1.055, vec3(2.4)), step(vec3(0.0404482), x));
}}

vec3 displayed_as(vec3 x) {{
  x = clamp(x, 0.0, 1.0);
  return mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.00313067), x));
}}

// Steps that the ray can go on without meeting matter; -1 where it may be next to some.
float clear_steps(vec3 place) {{
  vec3 size = vec3(textureSize(in_volume[0], 0));
  vec3 cell = place * size - 0.5;
  ivec3 block = clamp(ivec3(floor(cell / {BLOCK}.0)), ivec3(0), BLOCKS - 1);
  float away = table_at({LEVELS} + block.x + BLOCKS.x * (block.y + BLOCKS.y * block.z)).a;
  if (away == 0.0) return -1.0;
  vec3 stride = g_dirStep * size;
  stride = mix(stride, vec3(1e-12), lessThan(abs(stride), vec3(1e-12)));
  vec3 edge = {BLOCK}.0 * (vec3(block) + mix(vec3(1.0 - away), vec3(away), step(0.0, stride)));
  vec3 steps = (edge - cell) / stride;
  return floor(max(min(steps.x, min(steps.y, steps.z)), 0.0));
}}

bool matter_before = false;
"""

# VTK ends a ray at 254/255: what is opaque then is brought to 1, or the ground would shine through.
_WHOLE = """
if (g_fragColor.a > g_opacityThreshold) g_fragColor /= g_fragColor.a;
"""

_MARCH = f"""
float clear = g_skip || matter_before ? -1.0 : clear_steps(g_dataPos);
bool matter = false;
if (clear >= 0.0) {{
  g_dataPos += clear * g_dirStep;
  g_currentT += clear;
}} else {{
  matter = !g_skip && classified(level_of(texture3D(in_volume[0], g_dataPos))).a > 0.0;
}}
if (matter || matter_before) {{
  for (int part = {_PARTS - 1}; part >= 0; part--) {{
    vec3 place = g_dataPos - g_dirStep * (float(part) / {_PARTS}.0);
    vec4 texel = texture3D(in_volume[0], place);
    vec4 coat = classified(level_of(texel));
    if (coat.a > 0.0 && g_fragColor.a <= g_opacityThreshold) {{
      vec4 light = light_at(texel, place);
      float opacity = 1.0 - pow(1.0 - coat.a, in_sampleDistance * voxels_per_unit / {_PARTS}.0);
      opacity *= (1.0 - g_fragColor.a) * light.a;
      g_fragColor += opacity * vec4(displayed_as(coat.rgb * decoded(light.rgb)), 1.0);
    }}
  }}
}}
matter_before = matter;
"""


def volume_actor(values: NDArray[Any], volume: Grid, corner: Triple = (0, 0, 0)) -> vtkVolume:
    """Return a ``vtkVolume`` of voxels, in the volume's diagonals about the origin.

    Parameters
    ----------
    values : (nz, ny, nx) or (nz, ny, nx, k) array
        Of a box of the volume.
    volume : Volume
    corner : (x, y, z)
        The box's first voxel.
    """
    from vtkmodules.vtkRenderingCore import vtkVolume
    from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.SetInputDataObject(_unit_image(values, volume, corner))
    mapper.AutoAdjustSampleDistancesOff()
    mapper.SetSampleDistance(_voxel(volume))
    actor = vtkVolume()
    actor.SetMapper(mapper)
    properties = actor.GetProperty()
    properties.SetInterpolationTypeToLinear()
    properties.ShadeOff()
    for component in range(4):  # of RGBA the last one's counts
        properties.SetScalarOpacityUnitDistance(component, _voxel(volume))
    return actor


def ray_caster(actor: vtkVolume) -> vtkGPUVolumeRayCastMapper:
    """Return what casts the rays of an actor of `volume_actor`."""
    from vtkmodules.vtkRenderingVolume import vtkGPUVolumeRayCastMapper

    mapper = actor.GetMapper()
    assert isinstance(mapper, vtkGPUVolumeRayCastMapper)
    return mapper


def march(
    actor: vtkVolume,
    volume: Grid,
    levels: NDArray[Any],
    classes: NDArray[np.float32],
    light: str,
    more: NDArray[np.float32] | None = None,
) -> None:
    """Put these rays in the place of VTK's.

    Parameters
    ----------
    actor : vtkVolume
        From `volume_actor`, with two to four numbers a voxel.
    volume : Volume
    levels : (nz, ny, nx) array
        Of the actor's voxels: unsigned bytes, or floats in [0, 1].
    classes : (`LEVELS`, 4) array of float32
        Linear colour, and opacity per voxel.
    light : GLSL
        Defines ``float level_of(vec4 texel)``, the level in [0, 1], and ``vec4 light_at(vec4 texel,
        vec3 place)``: display values of the light at a place in texture coordinates, and 0 where
        nothing was shaded, else 1. With ``table_at(MORE + i)`` it finds row i of `more`.
    more : (n, 4) array of float32, optional

    Raises
    ------
    MeshdepictError
        For more numbers than a table holds.
    """
    import pyvista as pv

    away = clearance(levels, classes[:, 3])
    blocks = np.zeros((away.size, 4), np.float32)
    blocks[:, 3] = away.ravel()
    table = _table(classes, blocks, np.zeros((0, 4), np.float32) if more is None else more)
    sheet = pv.ImageData(dimensions=(table.shape[1], table.shape[0], 1))
    sheet.point_data["table"] = table.reshape(-1, 4)
    sheet.set_active_scalars("table")
    properties, shader = actor.GetProperty(), actor.GetShaderProperty()
    properties.IndependentComponentsOff()
    properties.SetTransferFunctionModeTo2D()
    properties.SetTransferFunction2D(0, sheet)
    shader.GetFragmentCustomUniforms().SetUniformf("voxels_per_unit", 1 / _voxel(volume))
    shader.ClearAllFragmentShaderReplacements()
    first, everywhere = True, False  # before VTK's own replacements
    bz, by, bx = away.shape
    known = (
        f"const int TABLE_WIDTH = {table.shape[1]}, MORE = {LEVELS + len(blocks)};\n"
        f"const ivec3 BLOCKS = ivec3({bx}, {by}, {bz});\n"
    )
    declared = "//VTK::RenderToImage::Dec"
    for tag, code in (
        (declared, f"{known}{_TABLE}{light}\n{declared}\n"),
        ("//VTK::PreComputeGradients::Impl", ""),  # two-dimensional tables would ask for them
        ("//VTK::Shading::Impl", _MARCH),
        ("//VTK::Shading::Exit", _WHOLE),
    ):
        shader.AddFragmentShaderReplacement(tag, first, code, everywhere)


def _table(*parts: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return rows of four numbers as an image (rows, columns, 4) that VTK hands over as it is."""
    count = sum(map(len, parts))
    # VTK interpolates images of other sides, but for a single row's height.
    wide = next((side for side in _SIDES if side >= count), None)
    if wide is not None:
        shape = (1, wide)
    else:
        sides = ((height, width) for width in _SIDES for height in _SIDES if height <= width)
        shape = next((s for s in sides if s[0] * s[1] >= count), (0, 0))
    if not shape[0]:
        raise MeshdepictError(
            f"{count * 16 / 1e9:.2g} GB of normals are more than a graphics card's table holds "
            f"({_SIDES[-1] ** 2 * 16 / 1e9:.2g} GB); bake the volume instead"
        )
    table = np.zeros((shape[0] * shape[1], 4), np.float32)
    np.concatenate(parts, out=table[:count])
    return table.reshape(*shape, 4)


def _voxel(volume: Grid) -> float:
    """Return the smallest spacing, in diagonals."""
    return float(volume.spacing.min()) / (volume.diagonal or 1.0)


def refill(actor: vtkVolume, values: NDArray[Any], volume: Grid) -> None:
    """Give an actor other values of the same voxels."""
    image: ImageData = ray_caster(actor).GetInput()
    image.point_data["values"][:] = _right_handed(values, volume)
    image.point_data["values"].VTKObject.Modified()
    image.Modified()


def _right_handed(values: NDArray[Any], volume: Grid) -> NDArray[Any]:
    """Return the rows of a grid's voxels, along x the other way where it is left-handed."""
    if np.linalg.det(volume.direction) < 0:
        values = values[:, :, ::-1]
    return values.reshape(values.shape[0] * values.shape[1] * values.shape[2], -1)


def _unit_image(values: NDArray[Any], volume: Grid, corner: Triple) -> ImageData:
    """Return voxels as ``pyvista.ImageData``, always on a right-handed grid.

    VTK's ray caster would draw a left-handed one inside out.
    """
    import pyvista as pv

    nz, ny, nx = values.shape[:3]
    first, direction = np.array(corner, np.float64), volume.direction
    if np.linalg.det(direction) < 0:
        first[0] += nx - 1
        direction = direction * (-1, 1, 1)
    image: ImageData = pv.ImageData(
        dimensions=(nx, ny, nz),
        spacing=volume.spacing / (volume.diagonal or 1.0),
        origin=volume.recentred(volume.to_world(first)),
        direction_matrix=direction,
    )
    image.point_data["values"] = _right_handed(values, volume)
    image.set_active_scalars("values")
    return image
