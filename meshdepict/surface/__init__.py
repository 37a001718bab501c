"""What a mesh is computed from: polygons and triangles, seams, edges, which way is out."""
