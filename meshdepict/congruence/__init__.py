"""How well a picture follows a shape."""

from meshdepict.congruence.judging import Flows, Judge, flows, picture, score
from meshdepict.congruence.lights import LIGHTS, light_directions

__all__ = ["LIGHTS", "Flows", "Judge", "flows", "light_directions", "picture", "score"]
