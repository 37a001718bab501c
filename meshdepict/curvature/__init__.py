"""Curvature: estimators on meshes."""
