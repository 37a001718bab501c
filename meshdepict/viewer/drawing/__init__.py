"""Pictures and movies without a window: layout, scale bar, canvas, volumes, files."""
