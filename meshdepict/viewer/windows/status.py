"""What a viewer says about what it shows, in short lines."""

from __future__ import annotations

from meshdepict.viewer.light_drag import angles, lights_of
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows.volume_session import VolumeSession

__all__ = ["color_line", "light_line", "view_line"]


def color_line(session: Session) -> str:
    """Return what decides the colours."""
    if isinstance(session, VolumeSession):
        return f"transfer function: {session.transfer.name}"
    return f"colour map: {session.colormap or 'gray'}"


def light_line(session: Session) -> str:
    """Return where the light is as the eye sees it, and what it is fixed to."""
    lights = lights_of(session.light)
    if not lights:
        return f"light: {session.light!s:.40}"
    azimuth, elevation = angles(lights[0], session.view)
    several = f" and {len(lights) - 1} more" if len(lights) > 1 else ""
    place = f"azimuth {round(azimuth) % 360}°, elevation {round(elevation)}°{several}"
    return f"light: {place}, fixed to the {session.light_fixed_to}"


def view_line(session: Session) -> str:
    """Return whether another view gives other colours."""
    if session.follows_view:
        return "shaded for this view"
    return "shaded alike for every view"
