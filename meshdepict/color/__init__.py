"""From values to colours: encoding, colour maps, transfer functions."""

from meshdepict.color.colormaps import colormap
from meshdepict.color.encoding import apply_colormap, encode, multiply_albedo
from meshdepict.color.srgb import linear_to_srgb, quantise, srgb_to_linear

__all__ = [
    "apply_colormap",
    "colormap",
    "encode",
    "linear_to_srgb",
    "multiply_albedo",
    "quantise",
    "srgb_to_linear",
]
