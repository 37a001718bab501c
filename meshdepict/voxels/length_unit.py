"""Units of length as files spell them, by one name each, "mm" for instance."""

from __future__ import annotations

import unicodedata

__all__ = ["MILLIMETRES", "length_unit"]

MILLIMETRES = {
    "nm": 1e-6, "µm": 1e-3, "mm": 1.0, "cm": 10.0, "dm": 100.0, "m": 1000.0, "km": 1e6,
    "in": 25.4, "ft": 304.8,
}  # fmt: skip
"""How many a unit of length is, by its name."""

_SPELT = {
    "nm": ("nanometer", "nanometre", "nanometers", "nanometres"),
    "µm": ("um", "micron", "microns", "micrometer", "micrometre", "micrometers", "micrometres",
           "mic"),
    "mm": ("millimeter", "millimetre", "millimeters", "millimetres"),
    "cm": ("centimeter", "centimetre", "centimeters", "centimetres"),
    "dm": ("decimeter", "decimetre", "decimeters", "decimetres"),
    "m": ("meter", "metre", "meters", "metres"),
    "km": ("kilometer", "kilometre", "kilometers", "kilometres"),
    "in": ("inch", "inches", '"'),
    "ft": ("foot", "feet"),
}  # fmt: skip
_NAMES = {spelt: name for name, others in _SPELT.items() for spelt in (name, *others)}


def length_unit(text: str) -> str:
    """Return the name of a unit of length, however it is spelt; "" for what is none ("pixel")."""
    # One letter for both micro signs, U+00B5 and the Greek U+03BC.
    word = unicodedata.normalize("NFC", text.strip(" \t\"'\0")).replace(
        "\N{GREEK SMALL LETTER MU}", "µ"
    )
    return _NAMES.get(word) or _NAMES.get(word.lower(), "")
