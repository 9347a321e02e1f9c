"""Meshes of 8-node quadrilaterals and 6-node triangles: generation, files, checks, location of points."""

from signorini.mesh.mesh import Location, Mesh

__all__ = ["Location", "Mesh"]
