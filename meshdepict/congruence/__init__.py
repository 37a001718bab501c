"""How well a picture follows a shape."""

from meshdepict.congruence.judging import (
    LIGHTS,
    Flows,
    Judge,
    flows,
    light_directions,
    picture,
    score,
)

__all__ = ["LIGHTS", "Flows", "Judge", "flows", "light_directions", "picture", "score"]
