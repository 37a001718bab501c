"""Procedural shapes for demonstrations, tests and benchmarks: the same bits every time.

Every function of a mesh takes the wanted number of vertices and returns the mesh whose own count is
the nearest that its layout has (each docstring says how near). All windings point outwards or up.
`ct_phantom` is a volume, `terrain` a height field, and `photographed_tablet` has a texture.
"""

from meshdepict.samples.coin import coin
from meshdepict.samples.golf_ball import golf_ball
from meshdepict.samples.inscription import inscription
from meshdepict.samples.knapped_core import knapped_core
from meshdepict.samples.landscape import terrain, terrain_height
from meshdepict.samples.phantom import ct_phantom
from meshdepict.samples.photographed import photographed_tablet
from meshdepict.samples.round import sphere, torus
from meshdepict.samples.sheets import radiating_ridges, ridge_height, wavy_sheet
from meshdepict.samples.tablet import tablet

__all__ = [
    "coin", "ct_phantom", "golf_ball", "inscription", "knapped_core", "photographed_tablet",
    "radiating_ridges", "ridge_height", "sphere", "tablet", "terrain", "terrain_height",
    "torus", "wavy_sheet",
]  # fmt: skip
