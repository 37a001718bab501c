"""Where people look: pictures and windows. PyVista and VTK are imported inside functions only."""
