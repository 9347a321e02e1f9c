"""Pictures of a plate: contours, open and closed supports, loads, sections.

Functions take arrays and return matplotlib axes or figures. The figures are made without pyplot, so that no display is
needed. matplotlib is imported at the first access to a function that draws.
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
