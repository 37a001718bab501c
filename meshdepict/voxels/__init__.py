"""What the scale space of a volume is computed from: Gaussians along axes, sums on grids."""
