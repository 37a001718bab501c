"""Where the eye is, where light comes from, what surfaces are made of."""

from meshdepict.scene.light import LIGHTS, Light, Lights, as_light, as_lighting, as_lights
from meshdepict.scene.view import VIEWS, View, as_view

__all__ = [
    "LIGHTS",
    "VIEWS",
    "Light",
    "Lights",
    "View",
    "as_light",
    "as_lighting",
    "as_lights",
    "as_view",
]
