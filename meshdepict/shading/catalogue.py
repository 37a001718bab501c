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
from meshdepict.shading.slope import slope as slope
from meshdepict.shading.normal_enhancement import normal_enhancement as normal_enhancement
from meshdepict.shading.unsharp_masking import unsharp_masking as unsharp_masking
from meshdepict.shading.accessibility import accessibility as accessibility
from meshdepict.shading.ambient_occlusion import ambient_occlusion as ambient_occlusion
from meshdepict.shading.sky_view import sky_view as sky_view
from meshdepict.shading.hillshade import hillshade as hillshade
from meshdepict.shading.multidirectional_hillshade import (
    multidirectional_hillshade as multidirectional_hillshade,
)
from meshdepict.shading.openness import positive_openness as positive_openness
from meshdepict.shading.openness import negative_openness as negative_openness
from meshdepict.shading.texture_shading import texture_shading as texture_shading
from meshdepict.shading.topographic_position import topographic_position as topographic_position
from meshdepict.shading.local_dominance import local_dominance as local_dominance
from meshdepict.shading.integral_invariant import integral_invariant as integral_invariant
from meshdepict.shading.view_curvature import view_curvature as view_curvature
