"""How far a mesh is from the plate: numbers on several meshes compared, and the mesh that is as near as asked."""
