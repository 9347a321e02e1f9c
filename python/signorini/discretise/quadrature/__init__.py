"""Quadrature over regions, curves and edges of a mesh, whether or not the mesh follows them."""

from signorini.discretise.quadrature.areas import area_quadrature, off_plate
from signorini.discretise.quadrature.lines import curve_quadrature, edge_quadrature
from signorini.discretise.quadrature.rules import GAUSS, LineQuadrature, Quadrature

__all__ = [
    "GAUSS",
    "LineQuadrature",
    "Quadrature",
    "area_quadrature",
    "curve_quadrature",
    "edge_quadrature",
    "off_plate",
]
