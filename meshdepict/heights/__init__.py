"""What height fields are computed from: gradients, smoothing, horizons; arrays, no HeightField."""
