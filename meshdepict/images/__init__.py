"""What a G-buffer is computed from: pixels, what they see, and filters that keep edges."""
