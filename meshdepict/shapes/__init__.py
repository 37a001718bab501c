"""What is shaded: meshes, volumes, images, and the documents that they came in."""
