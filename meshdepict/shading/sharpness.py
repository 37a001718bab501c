"""How sharp an alignment of lights single precision can follow; asked without a compiler."""

from __future__ import annotations

__all__ = ["SINGLE"]

# Sharpness γ above which the chain runs in double precision. A strength of 1 leaves a light e^−γ
# beside its guide, and the direction of that is what the next scale turns it by: in single
# precision the worst of 36,000 vertices was off by 0.2 grey levels at γ = 3, by 1.8 at 5, by 215
# at 8; above, up to 3 % of them were.
SINGLE = 4.0
