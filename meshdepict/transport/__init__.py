"""Rays: what light reaches a sample."""
