"""What makers of relief maps agree on: where lights stand, and what a horizon is.

No kernel stands here: whoever asks only for these numbers doesn't wait for a compiler.
"""

from __future__ import annotations

__all__ = ["HORIZONS", "MARK_AZIMUTHS", "MARK_ELEVATION"]

MARK_AZIMUTHS = (225.0, 270.0, 315.0, 360.0)
"""Where the four lights of Mark (1992) stand, in degrees; their weights add up to one."""

MARK_ELEVATION = 30.0

HORIZONS = ("lines", "cells")
