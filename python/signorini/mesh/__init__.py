"""A mesh of 8-node quadrilaterals: nodes, elements, named edges, and where points are in it."""

from signorini.mesh.mesh import Location, Mesh

__all__ = ["Location", "Mesh"]
