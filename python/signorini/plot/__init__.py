"""Pictures of a plate: contours, supports open or closed, loads, sections.

Takes arrays and returns matplotlib axes or figures that no global state knows of, so it needs no display. matplotlib is
read when a function that draws is first asked for.
"""

from signorini.base.lazy import lazily

__getattr__ = lazily(
    __name__,
    {
        "balance": ("BalanceMark",),
        "cuts": ("CutMark",),
        "field": ("contour", "line"),
        "files": ("DRAWN_BY", "save"),
        "load_path": ("load_path_picture",),
        "loads": ("LoadMark",),
        "marks": ("ZoneMark", "draw_legend", "supports"),
        "panel": ("draw_panel",),
        "picture": ("Job", "Panel", "Picture", "PressureLayer", "Sheet", "SupportMark"),
        "pictures": ("check_picture", "drawn", "drawn_as_png", "field_picture"),
        "places": ("EdgeMark", "SingularMark"),
        "plan": ("Plan",),
        "layers": ("pressure",),
        "profiles": ("profile_picture",),
        "refinement": ("refinement_picture",),
    },
)
