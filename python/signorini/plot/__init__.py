"""Pictures of a plate: contours, supports open or closed, loads, sections.

Takes arrays and returns matplotlib axes or figures that no global state knows of, so it needs no display.
"""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from signorini.plot.balance import BalanceMark
from signorini.plot.cuts import CutMark
from signorini.plot.field import contour, line
from signorini.plot.files import DRAWN_BY, save
from signorini.plot.load_path import load_path_picture
from signorini.plot.loads import LoadMark
from signorini.plot.marks import SupportMark, ZoneMark, draw_legend, supports
from signorini.plot.panel import Panel, draw_panel
from signorini.plot.pictures import Picture, check_picture, drawn_as_png, field_picture
from signorini.plot.places import EdgeMark, SingularMark
from signorini.plot.plan import Plan
from signorini.plot.pressure import PressureLayer, pressure
from signorini.plot.profiles import profiles_picture
from signorini.plot.refinement import refinement_picture

__all__ = [
    "DRAWN_BY",
    "Axes",
    "BalanceMark",
    "CutMark",
    "EdgeMark",
    "Figure",
    "LoadMark",
    "Panel",
    "Picture",
    "Plan",
    "PressureLayer",
    "SingularMark",
    "SupportMark",
    "ZoneMark",
    "check_picture",
    "contour",
    "draw_legend",
    "draw_panel",
    "drawn_as_png",
    "field_picture",
    "line",
    "load_path_picture",
    "pressure",
    "profiles_picture",
    "refinement_picture",
    "save",
    "supports",
]
