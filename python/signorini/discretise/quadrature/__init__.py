"""Quadrature over regions, curves and edges of a mesh, whether or not the mesh follows them."""

from signorini.discretise.quadrature.areas import Quadrature, area_quadrature, off_plate
from signorini.discretise.quadrature.lines import LineQuadrature, curve_quadrature, edge_quadrature

__all__ = ["LineQuadrature", "Quadrature", "area_quadrature", "curve_quadrature", "edge_quadrature", "off_plate"]
