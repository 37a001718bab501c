"""Where the eye is, where light comes from, what surfaces are made of."""

from meshdepict.scene.light import Light, Lights
from meshdepict.scene.names import LIGHTS, as_light, as_lighting, as_lights, as_view
from meshdepict.scene.view import VIEWS, View

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
