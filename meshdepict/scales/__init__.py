"""Normals of a shape at several widths."""
