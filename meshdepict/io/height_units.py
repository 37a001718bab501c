"""Units that heights are in: how files spell them, and how many metres they are."""

from __future__ import annotations

from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest
from meshdepict.voxels.length_unit import MILLIMETRES, length_unit

__all__ = ["METRES", "chosen_unit", "height_unit"]

METRES = {name: count / 1000 for name, count in MILLIMETRES.items() if name != "nm"} | {
    "us-ft": 1200 / 3937
}
"""How many a unit is, by its name."""

_SURVEY_FEET = (
    "us-ft", "us ft", "usft", "ftus", "ft us", "ft-us", "us survey foot", "us survey feet",
    "u.s. survey foot", "foot_us", "us_foot", "us foot", "us feet", "us_survey_foot",
    "us_survey_feet", "survey foot", "survey feet", "sfoot", "foot us", "us-foot", "us-feet",
)  # fmt: skip
_FEET = ("foot (international)", "international foot", "international feet", "foot_intl", "ft_intl",
         "ift", "intl foot")  # fmt: skip


def height_unit(text: str) -> str:
    """Return the name of a unit, however it is spelt; "" for what is none."""
    word = text.strip().lower()
    if word in _SURVEY_FEET:
        return "us-ft"
    found = "ft" if word in _FEET else length_unit(text)
    return found if found in METRES else ""


def chosen_unit(unit: str | None) -> str:
    """Return the name of a unit that somebody chose, "" for None.

    Raises
    ------
    MeshdepictError
        For what is no unit of length.
    """
    if unit is None:
        return ""
    name = height_unit(unit) if isinstance(unit, str) else ""
    if not name:
        raise MeshdepictError(
            f"unit={unit!r} is no unit of heights: use one of {', '.join(METRES)}"
            f"{nearest(str(unit), METRES)}"
        )
    return name
