"""Windows of PyVista on meshes and volumes: keys, panels, light in hand."""
