"""A vertex shader in the place of VTK's lighting: assembled, given its uniforms, and tried.

The colour is computed at every vertex and interpolated over the triangles, as baked ones are.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from meshdepict.errors import MeshdepictError

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkActor, vtkUniforms

__all__ = ["MOST_LIGHTS", "SURROUNDINGS", "Uniforms", "assemble", "caught_errors", "set_uniforms"]

MOST_LIGHTS = 64

Uniforms = dict[str, Any]  # float, int, tuple: a vector, list: numbers, (k, 4, 4) array: matrices

# What every method's GLSL finds: VTK declares the uniforms themselves.
SURROUNDINGS = """
vec3 light_direction(int k) {
  return vec3(lights[6 * k], lights[6 * k + 1], lights[6 * k + 2]);
}

vec3 light_color(int k) {
  return vec3(lights[6 * k + 3], lights[6 * k + 4], lights[6 * k + 5]);
}

// eye.w = 0: its direction, in a parallel view; 1: its place.
vec3 towards_eye() {
  vec3 away = eye.xyz - eye.w * vertexMC.xyz;
  float distance = length(away);
  return distance > 0.0 ? away / distance : view_axis;
}
"""

_DECLARE, _COMPUTE = "//VTK::Normal::Dec", "//VTK::Normal::Impl"
_PAINT = "//VTK::Light::Impl"


def assemble(actor: vtkActor, parts: Mapping[str, str], defines: Mapping[str, int]) -> None:
    """Replace an actor's lighting; the parts stand in the order in which they are given.

    Parameters
    ----------
    actor : vtkActor
    parts : {what: GLSL}
        Together they define ``unpack()``, ``shade()`` and ``encoded(vec3)``.
    defines : {name: int}
    """
    definitions = "".join(f"#define {name} {value}\n" for name, value in defines.items())
    code = definitions + "out vec3 depiction;\n" + "".join(parts.values())
    code = code.encode("ascii", "replace").decode()  # some drivers refuse more, even in comments
    shader = actor.GetShaderProperty()
    shader.ClearAllVertexShaderReplacements()
    shader.ClearAllFragmentShaderReplacements()
    vertex = {_DECLARE: code, _COMPUTE: "unpack();\ndepiction = encoded(shade());"}
    fragment = {
        _DECLARE: f"{_DECLARE}\nin vec3 depiction;",
        _PAINT: "fragOutput0 = vec4(depiction, opacity);",
    }
    first, everywhere = True, False  # before VTK's own replacements
    for place, text in vertex.items():
        shader.AddVertexShaderReplacement(place, first, f"{place}\n{text}\n", everywhere)
    for place, text in fragment.items():
        shader.AddFragmentShaderReplacement(place, first, f"{text}\n", everywhere)


def set_uniforms(given: vtkUniforms, uniforms: Uniforms) -> None:
    """Hand numbers to the shader: no vertex is touched.

    Parameters
    ----------
    given : vtkUniforms
        Of an actor's vertex or fragment shader.
    uniforms : {name: value}
        A float, an int, a tuple (vector), a list of floats, or (k, 4, 4) matrices that GLSL
        indexes in the same order.
    """
    for name, value in uniforms.items():
        if isinstance(value, np.ndarray):
            given.SetUniformMatrix4x4v(name, len(value), value.ravel().tolist())
        elif isinstance(value, list):
            given.SetUniform1fv(name, len(value), value)
        elif isinstance(value, tuple):
            (given.SetUniform3f if len(value) == 3 else given.SetUniform4f)(name, value)
        elif isinstance(value, int):
            given.SetUniformi(name, value)
        else:
            given.SetUniformf(name, value)


@contextmanager
def caught_errors(what: str) -> Iterator[None]:
    """Raise what VTK would print as one sentence, with the driver's own words.

    Raises
    ------
    MeshdepictError
        Where VTK reported an error, such as that a shader did not compile.
    """
    from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow

    window, former = vtkStringOutputWindow(), vtkOutputWindow.GetInstance()
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    vtkOutputWindow.SetInstance(window)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(verbosity)
        vtkOutputWindow.SetInstance(former)
    if reason := _reason(window.GetOutput()):
        raise MeshdepictError(f"{what} can't be shown live here: {reason}; bake it instead")


def _reason(output: str) -> str:
    """Return the compiler's first complaint, else VTK's first error, else nothing."""
    # The source is listed before with a number at each line: "76: …"; Mesa writes "0:76(47): error:
    # …", NVIDIA "0(76) : error C1008: …", Apple and AMD "ERROR: 0:76: …".
    found = re.search(r"^.*?\d+\)? ?: (?:error\b.*)$|^.*ERROR: \d+:.*$", output, flags=re.M)
    if found:
        line = re.sub(r"^vtk\w+ \(\w+\): ", "", found.group().strip())
        return f"the shader did not compile ({line.rstrip('.')})"
    found = re.search(r"^ERROR: .*\n(?:vtk\w+ \(\w+\): )?(.*)$", output, flags=re.M)
    return f"VTK says: {found.group(1).strip().rstrip('.')}" if found else ""
