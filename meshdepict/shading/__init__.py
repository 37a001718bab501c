"""Shading: one file per method, each a pure function of samples, a light and options."""

from __future__ import annotations

from meshdepict.shading.accessibility import accessibility
from meshdepict.shading.ambient_occlusion import ambient_occlusion
from meshdepict.shading.aspect import aspect
from meshdepict.shading.cook_torrance import cook_torrance
from meshdepict.shading.exaggerated import exaggerated
from meshdepict.shading.gooch import gooch
from meshdepict.shading.lambert import half_lambert, lambert
from meshdepict.shading.light_alignment import light_alignment
from meshdepict.shading.light_warping import light_warping
from meshdepict.shading.lit_sphere import lit_sphere
from meshdepict.shading.mean_curvature import mean_curvature
from meshdepict.shading.method import Declaration, declaration
from meshdepict.shading.normal_enhancement import normal_enhancement
from meshdepict.shading.phong import phong
from meshdepict.shading.radiance_scaling import radiance_scaling
from meshdepict.shading.registry import METHODS, find_method
from meshdepict.shading.sky_view import sky_view
from meshdepict.shading.toon import toon
from meshdepict.shading.unsharp_masking import unsharp_masking
from meshdepict.shading.view_curvature import view_curvature

__all__ = [
    "METHODS",
    "Declaration",
    "accessibility",
    "ambient_occlusion",
    "aspect",
    "cook_torrance",
    "declaration",
    "exaggerated",
    "find_method",
    "gooch",
    "half_lambert",
    "lambert",
    "light_alignment",
    "light_warping",
    "lit_sphere",
    "mean_curvature",
    "normal_enhancement",
    "phong",
    "radiance_scaling",
    "sky_view",
    "toon",
    "unsharp_masking",
    "view_curvature",
]
