"""Pictures of a plate: contours, supports open or closed, loads, sections.

Takes arrays and returns matplotlib axes or figures that no global state knows of, so it needs no display. matplotlib is
read when a function that draws is first asked for.
"""

from signorini.base.packages import lazily

_PICTURE = (
    *("BalanceMark", "CutMark", "EdgeMark", "LoadMark", "SingularMark", "SupportMark", "ZoneMark"),
    *("Panel", "Picture", "PressureLayer"),
)
__getattr__ = lazily(
    __name__,
    {
        "curves": ("line", "load_path_picture", "profile_picture"),
        "files": ("save",),
        "picture": _PICTURE,
        "pictures": ("check_picture", "drawn_as_png", "field_picture"),
        "plan": ("Plan",),
    },
)
