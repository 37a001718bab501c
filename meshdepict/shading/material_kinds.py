"""Kinds of materials that lights shine on, as numbers: compiled code tells them apart by these."""

from __future__ import annotations

__all__ = [
    "ASHIKHMIN_SHIRLEY", "COOK_TORRANCE", "HALF_LAMBERT", "LAMBERT", "PHONG", "SUB_LAMBERT",
]  # fmt: skip

# From PHONG on they have highlights.
LAMBERT, HALF_LAMBERT, SUB_LAMBERT, PHONG, COOK_TORRANCE, ASHIKHMIN_SHIRLEY = range(6)
