"""Gaussian sums over points, three ways; `gaussian` chooses."""
