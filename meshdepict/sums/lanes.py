"""Vectors of sixteen numbers in kernels, where a compiler left alone would not keep them so.

What loops over runs of unknown length becomes of a compiler takes three times as long as these do:
their number is known, so sums stay in registers, and no run has a rest to be done one by one.
Processors with shorter vectors take several for one. Products are added as ``a·b + c``, rounded
once where the processor can.

In a kernel some vectors together are one variable. How many they are follows from the length of a
tuple, ``like``: `many` makes it. None of these looks whether an array is long enough.
"""

from __future__ import annotations

from meshdepict.kernels.intrinsics import Intrinsic

__all__ = [
    "WIDE", "add", "add_each", "add_scaled", "add_to", "fill", "larger", "load", "lowest",
    "many", "minus", "nothing", "plus", "power_of_two", "rounded", "store", "store_each", "times",
    "within",
]  # fmt: skip

WIDE = 16
"""Numbers in a vector."""


def many(count: int) -> tuple[int, ...]:
    """Return what tells a kernel how many vectors of `WIDE` hold so many numbers."""
    return (0,) * -(-count // WIDE)


def _code(name: str) -> Intrinsic:
    return Intrinsic("meshdepict.sums.lane_code", name, WIDE)


add = _code("add")
add_each = _code("add_each")
add_scaled = _code("add_scaled")
add_to = _code("add_to")
fill = _code("fill")
larger = _code("larger")
load = _code("load")
lowest = _code("lowest")
minus = _code("minus")
nothing = _code("nothing")
plus = _code("plus")
power_of_two = _code("power_of_two")
rounded = _code("rounded")
store = _code("store")
store_each = _code("store_each")
times = _code("times")
within = _code("within")
