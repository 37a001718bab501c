"""`LiveVolume`: a method on the voxels of a volume, on the graphics card, within VTK's ray caster.

Beside its CT number every voxel has the number of its sample, and a table on the card the sample's
normals at every scale, packed as for meshes (`octahedral`): what a voxel needs, for those alone
that are shown, and as many scales as there are. Packed normals can't be interpolated, and normals
of voxels interpolated are not what a bake has; so where a ray meets matter, the eight voxels around
are shaded, and their colours are interpolated, as the card does with baked ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import quantise
from meshdepict.drawing.shader import SURROUNDINGS, set_uniforms
from meshdepict.drawing.volume_rays import march, ray_caster, volume_actor
from meshdepict.drawing.volume_scene import (
    levels_of,
    sample_box,
    transfer_classes,
    transfer_window,
)
from meshdepict.errors import MeshdepictError
from meshdepict.scales.grid_scales import GridSpace
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View
from meshdepict.viewer.live import encoding, octahedral
from meshdepict.viewer.live.look import (
    LiveLook,
    changed_options,
    live_lights,
    look_uniforms,
    switches,
)

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkVolume

    from meshdepict.drawing.plotter import Plotter

__all__ = ["LiveVolume"]

_MOST = 1 << 24  # whole numbers that float32 holds
_FLAT = -1.0  # the number of voxels without a normal, whose light is the middle of all methods

_EIGHT = """
float level_of(vec4 texel) {
  return texel.r;
}

vec3 shaded(ivec3 at, float number) {
  if (number < 0.0) return vec3(0.5);
  vertexMC = grid[0] * vec4(vec3(at), 1.0);
  int row = MORE + ROWS * (int(number) - 1);
  FETCH
  unpack();
  return encoded(shade());
}

vec4 light_at(vec4 texel, vec3 place) {
  ivec3 size = textureSize(in_volume[0], 0);
  vec3 cell = place * vec3(size) - 0.5;
  vec3 share = cell - floor(cell);
  vec4 sum = vec4(0.0);
  for (int corner = 0; corner < 8; corner++) {
    ivec3 side = ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
    ivec3 at = clamp(ivec3(floor(cell)) + side, ivec3(0), size - 1);
    vec3 near = mix(1.0 - share, share, vec3(side));
    float weight = near.x * near.y * near.z;
    float number = texelFetch(in_volume[0], at, 0).g;
    if (weight > 0.0 && number != 0.0) sum += weight * vec4(shaded(at, number), 1.0);
  }
  return sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : vec4(0.0);
}
"""


class LiveVolume(LiveLook):
    """A volume whose shading the graphics card computes anew in every frame.

    It shows what ``bake_volume(space, method, light=light, view=view, **options)`` would; what can
    be live, and how closely it agrees, is as for `LiveShading`. A new light or option sets
    uniforms. The voxels are passed over once, and again for another `curvature` or `scale`, and for
    another view where curvature is the view's.

    Parameters
    ----------
    space : GridSpace
        With a transfer function.
    method : str or function
    options : mapping, optional
        The method's own.
    light : light, or several
        As in `bake_volume`.
    view : View or str

    Attributes
    ----------
    actor : vtkVolume
        For ``plotter.renderer.AddVolume``, in the volume's diagonals about the origin.

    Raises
    ------
    MeshdepictError
        For what can't be live, and wrong options; nothing changes then.
    """

    _space: GridSpace
    actor: vtkVolume

    def _made(self, space: ScaleSpace) -> vtkVolume:
        grid = _checked(space)
        if self._colormap is not None:
            raise MeshdepictError(
                "colormap is about meshes: a volume has the colours of its transfer function"
            )
        self._attributes: Mapping[str, NDArray[np.float32]] = {}
        self._values, corner = _numbered(grid)
        return volume_actor(self._values, grid.shape, corner)

    def _enter(self, window: Plotter) -> None:
        window.renderer.AddVolume(self.actor)

    def _show(self, **changes: Any) -> None:
        """Check changes to light, options and view together, then make them."""
        method, space = self._method, self._space
        view: View = changes.get("view", self._view)
        light = changes.get("light", self._light)
        options = changed_options(method, self._options, changes.get("options", {}))
        lights = live_lights(method, light, view, options)
        uniforms = {
            **look_uniforms(method, space, lights, view, options),
            "grid": _grid_matrix(self.actor),
        }
        key = *method.key(view, options), method.reads(space, options)
        anew = key != self._key
        if anew:
            self._sets, self._attributes = method.attributes(space, view, options)
        defines = switches(method, self._sets, options)
        if anew or defines != self._defines:
            self._march(defines)
        set_uniforms(self.actor.GetShaderProperty().GetFragmentCustomUniforms(), uniforms)
        self._view, self._light = view, light
        self._options, self._key, self._defines = options, key, defines

    def _march(self, defines: Mapping[str, int]) -> None:
        """Hand normals and shader to the card."""
        space, rows = self._space, list(self._attributes.values())
        transfer = space.transfer
        assert transfer is not None
        more = np.zeros((len(space.points), len(rows), 4), np.float32)
        for k, row in enumerate(rows):
            more[:, k, : row.shape[1]] = row
        march(
            self.actor, space.shape, self._values[..., 0],
            transfer_classes(transfer, transfer_window(transfer, space.shape)),
            self._glsl(defines), more.reshape(-1, 4),
        )  # fmt: skip

    def _glsl(self, defines: Mapping[str, int]) -> str:
        unpacking = octahedral.unpacking(self._sets, bits=self._method.bits)
        declared = "vec4 vertexMC;\n" + unpacking.replace("in vec4", "vec4")
        fetch = []
        for row, (name, values) in enumerate(self._attributes.items()):
            size = values.shape[1]
            if not name.startswith("normals"):
                declared += f"vec{size} {name};\n"
            fetch.append(f"{name} = table_at(row + {row}).{'xyzw'[:size]};")
        known = {**defines, "ROWS": len(fetch)}
        return "".join(
            (
                *(f"#define {name} {value}\n" for name, value in known.items()),
                declared,
                SURROUNDINGS,
                self._method.glsl,
                encoding.GLSL,
                _EIGHT.replace("FETCH", "\n  ".join(fetch)),
            )
        )


def _checked(space: object) -> GridSpace:
    if not isinstance(space, GridSpace):
        raise MeshdepictError(
            "live shading of volumes needs the scale space of a volume's voxels; bake other shapes "
            "instead"
        )
    if space.transfer is None or space.transfer.gradient_opacity is not None:
        raise MeshdepictError(
            "live shading of volumes needs a transfer function of the CT number alone; bake the "
            "volume instead"
        )
    if len(space.points) > _MOST:
        raise MeshdepictError(
            f"live shading takes {_MOST:,} voxels, and {len(space.points):,} are shown; bake the "
            "volume instead"
        )
    return space


def _numbered(space: GridSpace) -> tuple[NDArray[np.float32], tuple[int, int, int]]:
    """Return levels and numbers of samples (from 1 on), (nz, ny, nx, 2), and their corner."""
    box = sample_box(space)
    low = (box[0].start, box[1].start, box[2].start)
    size = (box[0].stop - low[0], box[1].stop - low[1], box[2].stop - low[2])
    values = np.zeros((*size, 2), np.float32)
    assert space.transfer is not None
    window = transfer_window(space.transfer, space.shape)
    # The 256 levels of a bake's texture, so that the surface is where a bake has it.
    values[..., 0] = quantise(levels_of(space.shape.values[box], window)) / np.float32(255)
    numbers = values.reshape(-1, 2)[:, 1]
    numbers[space.samples.flat(size, low)] = np.arange(1, len(space.points) + 1)
    if len(space.flat):
        numbers[space.flat.flat(size, low)] = _FLAT
    return values, (low[2], low[1], low[0])


def _grid_matrix(actor: vtkVolume) -> NDArray[np.float64]:
    """Return the matrix (1, 4, 4) from voxels to the scene, by columns as GLSL has them."""
    image = ray_caster(actor).GetInput()
    matrix = image.GetIndexToPhysicalMatrix()
    found = [[matrix.GetElement(row, column) for row in range(4)] for column in range(4)]
    return np.array([found])
