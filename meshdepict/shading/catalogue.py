"""Every method, a line each, in the order in which lists show them; `registry` makes METHODS."""
# isort: off

from meshdepict.shading.exaggerated import exaggerated as exaggerated
from meshdepict.shading.light_warping import light_warping as light_warping
from meshdepict.shading.radiance_scaling import radiance_scaling as radiance_scaling
from meshdepict.shading.light_alignment import light_alignment as light_alignment
from meshdepict.shading.lambert import lambert as lambert
from meshdepict.shading.lambert import half_lambert as half_lambert
from meshdepict.shading.phong import phong as phong
from meshdepict.shading.cook_torrance import cook_torrance as cook_torrance
from meshdepict.shading.toon import toon as toon
from meshdepict.shading.lit_sphere import lit_sphere as lit_sphere
from meshdepict.shading.mean_curvature import mean_curvature as mean_curvature
from meshdepict.shading.gooch import gooch as gooch
from meshdepict.shading.aspect import aspect as aspect
from meshdepict.shading.normal_enhancement import normal_enhancement as normal_enhancement
from meshdepict.shading.unsharp_masking import unsharp_masking as unsharp_masking
from meshdepict.shading.accessibility import accessibility as accessibility
from meshdepict.shading.ambient_occlusion import ambient_occlusion as ambient_occlusion
from meshdepict.shading.sky_view import sky_view as sky_view
from meshdepict.shading.view_curvature import view_curvature as view_curvature
