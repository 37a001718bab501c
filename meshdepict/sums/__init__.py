"""Gaussian sums over points, two ways; `gaussian` chooses."""
