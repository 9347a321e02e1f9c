"""A mesh of 8-node quadrilaterals and 6-node triangles: nodes, elements, named edges, and where points are in it."""

from signorini.mesh.mesh import Location, Mesh

__all__ = ["Location", "Mesh"]
